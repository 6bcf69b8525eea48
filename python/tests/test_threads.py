"""Promise: a long step lets other threads run, ends on Ctrl-C, and survives forks."""

from __future__ import annotations

import threading
from pathlib import Path
from types import ModuleType

import pytest

from models import boxes_on_ground, floating, in_process

INTERRUPTED = """
import os, signal, sys, threading, time
import importlib
lib = importlib.import_module(sys.argv[1])
simulation, batch = lib.Simulation("t-handle"), lib.Batch("t-handle", 3)
out = batch.states
calls = {
    "step": lambda: simulation.step(2**32 - 1),
    "record": lambda: simulation.record(10**6, every=1),
    "batch": lambda: batch.step(2**32 - 1),
    "out": lambda: batch.step(2**32 - 1, out=out),
}
signals = {"raise": lambda: signal.raise_signal(signal.SIGINT), "kill": lambda: os.kill(os.getpid(), signal.SIGINT)}
call, before = calls[sys.argv[2]], out.copy()
threading.Timer(0.2, signals[sys.argv[3]]).start()
try:
    call()
    sys.exit("was not interrupted")
except KeyboardInterrupt:
    pass
made = batch if sys.argv[2] in ("batch", "out") else simulation
done = int(batch.steps[0]) if made is batch else simulation.steps
assert 0 < done < 10**6 if sys.argv[2] == "record" else 0 < done < 2**32 - 1, done
assert (out == before).all()
if made is batch:
    assert len(set(batch.steps.tolist())) == 1 and len(set(batch.state_hashes())) == 1
made.step(5)
again = lib.Simulation("t-handle")
again.step(done + 5)
assert again.state_hash == (batch.state_hashes()[0] if made is batch else simulation.state_hash)
print("usable")
"""

FORKED = """
import importlib, multiprocessing, sys

def hashes(name):
    lib = importlib.import_module(name)
    batch, simulation = lib.Batch("cradle", 8), lib.Simulation("pyramid")
    batch.step(20)
    simulation.step(2)
    simulation.totals(), batch.energies(), simulation.cast_rays([0, 50, 0], [0, -1, 0])
    return [*batch.state_hashes(), simulation.state_hash]

def going_on(_):
    batch.step(20)
    simulation.step(2)
    return [*batch.state_hashes(), simulation.state_hash]

if __name__ == "__main__":
    name, way = sys.argv[1:]
    lib = importlib.import_module(name)
    lib.set_threads(3)
    wanted = hashes(name)
    batch, simulation = lib.Batch("cradle", 8), lib.Simulation("pyramid")
    batch.step(1)
    simulation.step(1)
    context = multiprocessing.get_context(way)
    with context.Pool(2) as pool:
        assert pool.map_async(hashes, [name] * 4).get(timeout=50) == [wanted] * 4
        if way == "fork":
            theirs = pool.map_async(going_on, [0], chunksize=1).get(timeout=50)
            assert theirs == [going_on(0)]
    assert hashes(name) == wanted
    print("same")
"""


@pytest.mark.parametrize("way", ["raise", "kill"])
@pytest.mark.parametrize("call", ["step", "record", "batch", "out"])
def test_ctrl_c_ends_a_long_call_between_two_steps(lib: ModuleType, call: str, way: str, tmp_path: Path) -> None:
    assert in_process(tmp_path, INTERRUPTED, lib.__name__, call, way) == "usable\n"


@pytest.mark.parametrize("way", ["fork", "spawn", "forkserver"])
def test_a_child_process_steps_though_the_parent_has_threads(lib: ModuleType, way: str, tmp_path: Path) -> None:
    assert in_process(tmp_path, FORKED, lib.__name__, way).endswith("same\n")


@pytest.mark.parametrize("kind", ["Simulation", "Batch"])
def test_other_threads_run_while_one_steps(lib: ModuleType, kind: str) -> None:
    made = lib.Simulation("t-handle") if kind == "Simulation" else lib.Batch("t-handle", 4)
    counted, is_over = 0, threading.Event()

    def count() -> None:
        nonlocal counted
        while not is_over.wait(0.001):
            counted += 1

    other = threading.Thread(target=count)
    other.start()
    try:
        before = counted
        made.step(1_500_000 if kind == "Simulation" else 500_000)
        during = counted - before
    finally:
        is_over.set()
        other.join()
    # It lasts some tenths of a second; without other threads there would be two counts at most.
    assert during >= 10


@pytest.mark.parametrize("kind", ["Simulation", "Batch"])
def test_one_object_in_two_threads_at_once_is_an_error(lib: ModuleType, kind: str) -> None:
    made = lib.Simulation("t-handle") if kind == "Simulation" else lib.Batch("t-handle", 4)
    steps = 2_000_000 if kind == "Simulation" else 500_000
    stepping = threading.Thread(target=made.step, args=(steps,))
    uses = [lambda: made.positions, made.step, lambda: made.push(forces=1), lambda: made.drive_names]
    uses += [made.record, lambda: made.record(1)] if kind == "Simulation" else [made.reset, made.energies]
    refused: set[int] = set()
    stepping.start()
    try:
        while stepping.is_alive() and len(refused) < len(uses):
            for at, use in enumerate(uses):
                try:
                    # Before the other thread began, others than the first would do their work.
                    if at == 0 or refused:
                        use()
                except RuntimeError as error:
                    assert "borrowed" in str(error)
                    refused.add(at)
    finally:
        stepping.join()
    assert refused == set(range(len(uses)))
    assert made.positions.shape[-1] == 3


def test_many_threads_with_an_object_each_get_the_bits_of_one(lib: ModuleType) -> None:
    alone = lib.Simulation(boxes_on_ground(4))
    alone.step(100)
    found: list[str] = []

    def run() -> None:
        simulation, batch = lib.Simulation(boxes_on_ground(4)), lib.Batch(boxes_on_ground(4), 4)
        for _ in range(10):
            simulation.step(10)
            batch.step(10)
        found.extend([simulation.state_hash, *batch.state_hashes()])

    threads = [threading.Thread(target=run) for _ in range(6)]
    for thread in threads:
        thread.start()
    lib.set_threads(1)
    lib.set_threads(4)
    for thread in threads:
        thread.join()
    assert len(found) == 30 and set(found) == {alone.state_hash}


def test_the_number_of_threads_is_as_it_was_set(lib: ModuleType) -> None:
    for count in (1, 3):
        lib.set_threads(count)
        assert lib.threads() == count
    lib.set_threads(0)
    assert lib.threads() >= 1
    for count in (-1, 1025, 2**62):
        with pytest.raises(lib.ArgumentError) as caught:
            lib.set_threads(count)
        assert caught.value.field == "count"
    assert lib.threads() >= 1


def test_an_argument_that_uses_the_object_again_is_an_error(lib: ModuleType) -> None:
    simulation = lib.Simulation(floating(2))

    class Again:
        def __array__(self, *arguments: object, **options: object) -> object:
            return simulation.positions

    with pytest.raises((RuntimeError, lib.ArgumentTypeError)):
        simulation.push(forces=Again())
    simulation.step()
