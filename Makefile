# Two commands are all that a newcomer needs: make demo, make test.
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

# Every program that the tests start would compile its imports again.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo console test test-full coverage check docs format bench requirements clean

demo: $(BASE)
	@$(BIN)/scope ask "$(DEMO)" --next-steps

# The operator's page in a browser.
console: $(DEV)
	@$(BIN)/scope console

# Each worker runs whole files, so that the fixtures of a file are made once. Four workers on two cores, because many tests wait.
# Tests of browsers, servers and live streams compete for the processor: a test that fails runs up to twice more, and the summary
# lists it.
RERUNS := --reruns 2 --reruns-delay 1 -raR
test: $(DEV)
	$(BIN)/pytest -q -n 4 --dist loadfile $(RERUNS) -m "not full" tests

# In the order of the folders, because by default files of one test come last, and the longest tests are in such files.
test-full: test $(FULL)
	$(BIN)/pytest -q -n 2 --dist loadfile --no-loadscope-reorder $(RERUNS) -m full tests

# Both tiers again with line coverage of everything but the modelling code, which runs inside Blender.
coverage: $(FULL)
	$(BIN)/pytest -q -n 2 --dist loadfile --cov --cov-report= -m "not full" tests
	$(BIN)/pytest -q --cov --cov-append --cov-report=term:skip-covered -m full tests

check: $(DEV)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(SITE)

# Warnings are errors: a broken link, a docstring that does not render, a missing file.
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

# Serving code and torch, for tiny models. pip and not uv, because pip takes a build for processors where one is offered.
$(FULL): requirements/full.txt $(DEV)
	@$(UV) pip install -q --python $(BIN)/python -r requirements/full.txt pip
	@$(BIN)/python -m pip install -q --disable-pip-version-check "$(TORCH)"
	@touch $@

# Pins without index lines: `make requirements` after a change of dependencies in pyproject.toml.
requirements: | $(VENV)/pyvenv.cfg
	$(UV) pip compile -q --universal --python-version 3.11 --no-header --no-emit-index-url pyproject.toml -o requirements/base.txt
	$(UV) pip compile -q --universal --python-version 3.11 --no-header --no-emit-index-url --group dev pyproject.toml -o requirements/dev.txt
	@echo "torch; sys_platform == 'never'" > $(VENV)/no-torch.txt
	$(UV) pip compile -q --universal --python-version 3.11 --no-header --no-annotate --no-emit-index-url --group full \
		--override $(VENV)/no-torch.txt -c requirements/dev.txt pyproject.toml | grep -v "'never'" > requirements/full.txt

clean:
	rm -rf $(VENV) docs/_build .pytest_cache .ruff_cache .mypy_cache .hypothesis
