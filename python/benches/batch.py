"""What Python costs: 4096 worlds of eight boxes, free and on a plane, 16 steps a call.

    cargo build --release -p tumble-tests --example batch_calls
    python python/benches/batch.py target/release/examples/batch_calls [THREADS] [ROUNDS]

Steps the same scene from Python, in Rust, and with MuJoCo's `rollout` where that is installed, one
after the other in each round, each in a process of its own, and prints the medians of the rounds.
"""

from __future__ import annotations

import importlib.util
import json
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

WORLDS, BODIES, STEPS = 4096, 8, 16
DT = 1 / 60


def boxes() -> list[dict[str, Any]]:
    """Two by two by two metre cubes, each a little turned, over the ground."""
    chance = np.random.default_rng(1)
    found = []
    for index in range(BODIES):
        place = [(index & 1) * 1.2, 1.0 + (index >> 1 & 1) * 1.2, (index >> 2) * 1.2]
        found.append(
            {
                "name": f"box-{index}",
                "shape": {"cuboid": {"half_extents": [0.5, 0.5, 0.5]}},
                "mass": 1.0,
                "position": (np.array(place) + chance.uniform(-0.1, 0.1, 3)).tolist(),
                "angular_velocity": chance.uniform(-0.6, 0.6, 3).tolist(),
            }
        )
    return found


def scene(on_plane: bool) -> dict[str, Any]:
    bodies = boxes()
    if on_plane:
        for body in bodies:
            body["collider"] = {"friction": 0.5}
        bodies.append({"name": "ground", "shape": {"half_space": {}}, "fixed": True, "collider": {"friction": 0.5}})
    return {"dt": DT, "bodies": bodies}


def calls(on_plane: bool) -> int:
    """How many calls are timed: the first dozen of short ones are slower."""
    return 9 if on_plane else 61


def median_time(call: Callable[[], Any], count: int) -> float:
    times = []
    for _ in range(count):
        begun = time.perf_counter()
        call()
        times.append(time.perf_counter() - begun)
    return statistics.median(times)


def in_python(on_plane: bool, threads: int) -> dict[str, float]:
    import tumble

    tumble.set_threads(threads)
    batch = tumble.Batch(scene(on_plane), WORLDS)
    out = batch.states
    # What begins in the air comes to the ground first, as in Rust.
    batch.step(120)
    return {
        "python": median_time(lambda: batch.step(STEPS), calls(on_plane)),
        "python with out": median_time(lambda: batch.step(STEPS, out=out), calls(on_plane)),
        "read": median_time(lambda: batch.read_states(out), calls(on_plane)),
    }


def in_mujoco(on_plane: bool, threads: int) -> dict[str, float]:
    import mujoco
    from mujoco import rollout

    passes = "" if on_plane else 'contype="0" conaffinity="0"'
    bodies = "".join(
        f'<body pos="{body["position"][0]} {body["position"][1]} {body["position"][2]}"><freejoint/>'
        f'<geom type="box" size="0.5 0.5 0.5" mass="1" {passes}/></body>'
        for body in boxes()
    )
    plane = '<geom type="plane" size="50 50 1" zaxis="0 1 0"/>' if on_plane else ""
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{DT}" gravity="0 -9.81 0"/><worldbody>{plane}{bodies}</worldbody></mujoco>'
    )
    datas = [mujoco.MjData(model) for _ in range(threads)]
    datas[0].qvel[3::6] = 0.3
    for _ in range(120):
        mujoco.mj_step(model, datas[0])
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    state = np.zeros(size)
    mujoco.mj_getState(model, datas[0], state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    starts = np.tile(state, (WORLDS, 1))
    states = np.empty((WORLDS, STEPS, size))
    call = lambda: rollout.rollout(model, datas, starts, nstep=STEPS, state=states, persistent_pool=True)  # noqa: E731
    call()
    return {f"MuJoCo {mujoco.__version__} rollout": median_time(call, 3)}


def in_rust(program: str, on_plane: bool, threads: int) -> dict[str, float]:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.json"
        path.write_text(json.dumps(scene(on_plane)))
        command = [program, str(path), str(WORLDS), str(STEPS), str(calls(on_plane)), str(threads)]
        return {"rust": float(subprocess.run(command, capture_output=True, text=True, check=True).stdout)}


def alone(part: str, on_plane: bool, threads: int) -> dict[str, float]:
    """A part in a process of its own: what one leaves behind is not what another finds."""
    command = [sys.executable, __file__, "--part", part, str(int(on_plane)), str(threads)]
    found: dict[str, float] = json.loads(subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout)
    return found


def compare(program: str, on_plane: bool, threads: int, count: int) -> None:
    rounds = []
    for _ in range(count):
        found = alone("python", on_plane, threads) | in_rust(program, on_plane, threads)
        if importlib.util.find_spec("mujoco"):
            found |= alone("mujoco", on_plane, threads)
        rounds.append(found)
    print(f"{'on a plane' if on_plane else 'free'}, {threads} threads, {count} rounds")
    medians = {name: statistics.median(found[name] for found in rounds) for name in rounds[0]}
    for name, seconds in medians.items():
        rate = "" if name == "read" else f" {WORLDS * BODIES * STEPS / seconds / 1e6:9.3f} M body-steps/s"
        print(f"  {name:24} {1e3 * seconds:9.3f} ms a call{rate}")
    ratio = statistics.median(found["rust"] / found["python"] for found in rounds)
    step = medians["python"] / STEPS
    reading, writing = medians["read"] / step, (medians["python with out"] - medians["python"]) / step
    print(f"  Python reaches {100 * ratio:.1f} % of Rust")
    print(f"  states cost {100 * reading:.0f} % of a step when read, {100 * writing:.0f} % with out")


def main() -> None:
    if sys.argv[1] == "--part":
        parts = {"python": in_python, "mujoco": in_mujoco}
        print(json.dumps(parts[sys.argv[2]](sys.argv[3] == "1", int(sys.argv[4]))))
        return
    threads, count = (int(text) for text in (sys.argv[2:] + ["2", "5"][len(sys.argv) - 2 :]))
    for on_plane in (False, True):
        compare(sys.argv[1], on_plane, threads, count)


if __name__ == "__main__":
    main()
