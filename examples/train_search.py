"""Train a small policy for active search with the cross-entropy method, and print its learning curve.

    python examples/train_search.py --minutes 10

The policy computes each move from the detections with eight weights. Before training, it does not know where to turn, where to
look next, or when to submit. It needs no deep learning library: pip install "scope-ptz[gym]"
"""

import argparse
import time

import numpy as np

from scope_ptz.gym import SearchEnv, SearchOutcome, search_score

MAX_LOOKS = 12
WEIGHTS = 8
ELITE_FRACTION, MIN_STD = 0.2, 0.05
HELD_OUT_SEED = 1_000_000  # evaluation uses seeds from here on, training uses smaller seeds


class Policy:
    """A policy with eight weights. It remembers only its direction of turn, which it reverses at the end of the pan range."""

    def __init__(self, weights):
        self.weights, self.direction, self.last_pan = weights, 1.0, None

    def act(self, observation):
        pan, tilt, _ = observation["pose"]
        found, x, y, *_ = observation["detection"]
        if self.last_pan is not None and abs(pan - self.last_pan) < 1.0:
            self.direction = -self.direction
        self.last_pan = pan
        w, dx, dy = self.weights, x - 0.5, y - 0.5
        if found:
            move = [0.4 * w[0] * dx, 0.4 * w[1] * dy, 0.0, w[2] - 4 * w[3] * max(abs(dx), abs(dy))]
        else:
            move = [0.4 * w[4] * self.direction, 0.2 * w[5] + 0.3 * w[6] * tilt / 30, 0.0, w[7]]
        return np.tanh(move).astype(np.float32)


def search(env, weights, seed):
    """Run one search. Return its outcome and its fitness.

    Successes are rare at first, so a search that ends with the target in view also gets a reward, which is greater near the centre.
    """
    policy, done = Policy(weights), False
    observation, info = env.reset(seed=seed)
    while not done:
        observation, _, terminated, truncated, info = env.step(policy.act(observation))
        done = terminated or truncated
    found, x, y, *_ = observation["detection"]
    in_view = 0.3 * (1 - max(abs(x - 0.5), abs(y - 0.5))) if found else 0.0
    return SearchOutcome(info["success"], info["looks"]), info["score"] + in_view


def evaluate(env, weights, episodes):
    """Print the success rate, the mean number of looks and the mean score of held-out searches. Return the mean score."""
    outcomes = [search(env, weights, HELD_OUT_SEED + number)[0] for number in range(episodes)]
    success = np.mean([outcome.success for outcome in outcomes])
    score = np.mean([search_score(outcome.success, outcome.looks, MAX_LOOKS) for outcome in outcomes])
    looks = np.mean([outcome.looks for outcome in outcomes])
    print(f"held-out searches: success {success:.0%}, {looks:.1f} looks, score {score:.2f}", flush=True)
    return score


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--generations", type=int, default=1000, help="stop after this number of generations, even if time is left")
    parser.add_argument("--population", type=int, default=24)
    parser.add_argument("--episodes", type=int, default=5, help="number of searches per policy")
    parser.add_argument("--held-out", type=int, default=50, help="number of searches in the evaluation")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()

    env = SearchEnv("highway-works", perception="noisy", frames=False, max_looks=MAX_LOOKS)
    rng = np.random.default_rng(options.seed)
    mean, std = np.zeros(WEIGHTS), np.ones(WEIGHTS)
    before = evaluate(env, mean, options.held_out)
    deadline = time.monotonic() + 60 * options.minutes
    for generation in range(1, options.generations + 1):
        policies = mean + std * rng.normal(size=(options.population, mean.size))
        seeds = rng.integers(HELD_OUT_SEED, size=options.episodes).tolist()  # the same searches for all policies
        runs = [[search(env, weights, seed) for seed in seeds] for weights in policies]
        fitness = np.array([np.mean([value for _, value in run]) for run in runs])
        elite = policies[np.argsort(fitness)[-max(2, round(ELITE_FRACTION * options.population)) :]]
        mean, std = elite.mean(axis=0), np.maximum(elite.std(axis=0), MIN_STD)
        success = np.mean([outcome.success for run in runs for outcome, _ in run])
        print(
            f"generation {generation:3}: fitness {fitness.mean():.3f}, best {fitness.max():.3f}, success {success:.0%}", flush=True
        )
        if time.monotonic() > deadline:
            break
    after = evaluate(env, mean, options.held_out)
    print(f"score before and after training: {before:.2f} and {after:.2f}")
    env.close()


if __name__ == "__main__":
    main()
