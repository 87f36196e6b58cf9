# Newcomers need only two commands: make demo and make test.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
UV := $(shell command -v uv 2>/dev/null || echo $(BIN)/uv)
BASE := $(VENV)/.base-installed
DEV := $(VENV)/.dev-installed
FULL := $(VENV)/.full-installed
TORCH := torch==2.13.0
SITE := $(BIN)/sphinx-build -q -W --keep-going docs docs/_build/html
DEMO := Go to the highway preset, then pan right in 15 degree steps until you see at least six cones

# If this variable were set, every program that the tests start would compile its imports again.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo console test test-full coverage check docs format bench requirements clean

demo: $(BASE)
	@$(BIN)/scope ask "$(DEMO)" --next-steps

# The operator's page in a browser.
console: $(DEV)
	@$(BIN)/scope console

# Each worker runs whole files, so that the fixtures of a file are created once. Four workers suit two cores, because many tests wait.
# Tests of browsers, servers and live streams compete for the processor, so a failing test is rerun up to twice. The summary lists
# the reruns.
RERUNS := --reruns 2 --reruns-delay 1 -raR
test: $(DEV)
	$(BIN)/pytest -q -n 4 --dist loadfile $(RERUNS) -m "not full" tests

# Files run in the order of the folders. By default, files with a single test run last, and these contain the longest tests.
test-full: test $(FULL)
	$(BIN)/pytest -q -n 2 --dist loadfile --no-loadscope-reorder $(RERUNS) -m full tests

# Both tiers with line coverage of everything except the modelling code, which runs inside Blender.
coverage: $(FULL)
	$(BIN)/pytest -q -n 2 --dist loadfile --cov --cov-report= -m "not full" tests
	$(BIN)/pytest -q --cov --cov-append --cov-report=term:skip-covered -m full tests

check: $(DEV)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(SITE)

# Warnings are errors, such as broken links, missing files, and docstrings that do not render.
docs: $(DEV)
	@$(SITE)
	@echo "Open docs/_build/html/index.html in a browser."

format: $(DEV)
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

bench: $(DEV)
	$(BIN)/python benchmarks/reprojection.py
	$(BIN)/python benchmarks/plan_latency.py
	$(BIN)/python benchmarks/startup.py

$(VENV)/pyvenv.cfg:
	@if command -v uv >/dev/null 2>&1; then uv venv -q --python ">=3.11" $(VENV); \
	else $(PYTHON) -m venv $(VENV) && $(BIN)/python -m pip install -q --disable-pip-version-check uv; fi

$(BASE): requirements/base.txt pyproject.toml | $(VENV)/pyvenv.cfg
	@$(UV) pip install -q --python $(BIN)/python -r requirements/base.txt
	@$(UV) pip install -q --python $(BIN)/python --no-deps -e .
	@touch $@

$(DEV): requirements/dev.txt $(BASE)
	@$(UV) pip install -q --python $(BIN)/python -r requirements/dev.txt
	@touch $@

# Model serving and torch, for tests with tiny models. pip installs torch, because it prefers a CPU build if one is available.
$(FULL): requirements/full.txt $(DEV)
	@$(UV) pip install -q --python $(BIN)/python -r requirements/full.txt pip
	@$(BIN)/python -m pip install -q --disable-pip-version-check "$(TORCH)"
	@touch $@

# Pin all dependencies, without index lines. Run `make requirements` after changing the dependencies in pyproject.toml.
requirements: | $(VENV)/pyvenv.cfg
	$(UV) pip compile -q --universal --python-version 3.11 --no-header --no-emit-index-url pyproject.toml -o requirements/base.txt
	$(UV) pip compile -q --universal --python-version 3.11 --no-header --no-emit-index-url --group dev pyproject.toml -o requirements/dev.txt
	@echo "torch; sys_platform == 'never'" > $(VENV)/no-torch.txt
	$(UV) pip compile -q --universal --python-version 3.11 --no-header --no-annotate --no-emit-index-url --group full \
		--override $(VENV)/no-torch.txt -c requirements/dev.txt pyproject.toml | grep -v "'never'" > requirements/full.txt

clean:
	rm -rf $(VENV) docs/_build .pytest_cache .ruff_cache .mypy_cache .hypothesis
