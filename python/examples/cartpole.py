"""Learns to balance a pole: the cross-entropy method for a linear policy, in NumPy.

Each world of one batch tries its own weights for an episode. The best eighth gives the mean and
spread of the weights of the next iteration.

    python examples/cartpole.py
"""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from tumble.envs import CartPole

ITERATIONS = 12
EVALUATED = 100
SOLVED = 475.0


def returns_of(env: CartPole, weights: NDArray[np.float64], seed: int) -> NDArray[np.float64]:
    """Returns (num_envs,) of one episode in each world, with weights (4,) or (num_envs, 4)."""
    observations, _ = env.reset(seed=seed)
    returns = np.zeros(env.num_envs)
    alive = np.ones(env.num_envs, np.bool_)
    while alive.any():
        actions = ((observations * weights).sum(axis=1) > 0).astype(np.int64)
        observations, rewards, terminated, truncated, _ = env.step(actions)
        returns += rewards * alive
        alive &= ~(terminated | truncated)
    return returns


def learn(seed: int, worlds: int) -> NDArray[np.float64]:
    """Weights (4,) of a policy: where their sum over observations is positive it pushes to +x."""
    random = np.random.default_rng(seed)
    env = CartPole(worlds)
    mean, spread = np.zeros(4), np.ones(4)
    for iteration in range(ITERATIONS):
        weights = mean + spread * random.standard_normal((worlds, 4))
        # Only the direction matters for the policy; one length keeps the spread meaningful.
        weights /= np.linalg.norm(weights, axis=1, keepdims=True)
        returns = returns_of(env, weights, seed * 1000 + iteration)
        elite = weights[np.argsort(-returns, kind="stable")[: worlds // 8]]
        mean, spread = elite.mean(axis=0), elite.std(axis=0) + 0.02
        solved = float((returns >= SOLVED).mean())
        print(f"iteration {iteration:2}: mean return {returns.mean():5.1f}, {solved:4.0%} balance")
        if solved >= 0.8:
            break
    env.close()
    return mean


def main(seed: int = 1, worlds: int = 256) -> float:
    """Learns, and evaluates over 100 episodes of other seeds: their mean return."""
    begun = time.perf_counter()
    weights = learn(seed, worlds)
    returns = returns_of(CartPole(EVALUATED), weights, seed * 1000 + 500)
    mean = float(returns.mean())
    print(f"weights {np.round(weights, 3)}")
    print(f"{EVALUATED} other episodes: mean return {mean:.1f}, least {returns.min():.0f}")
    print(f"{time.perf_counter() - begun:.1f} s")
    return mean


if __name__ == "__main__":
    main()
