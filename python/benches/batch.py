"""What Python costs: 4096 worlds of eight boxes, free and on a plane, 16 steps a call.

    cargo build --release --example batch_calls
    python python/benches/batch.py target/release/examples/batch_calls [THREADS] [ROUNDS]

Steps the same scene from Python, in Rust, and with MuJoCo's `rollout` where that is installed, one
after the other in each round, and prints the medians of the rounds.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import tumble

WORLDS, BODIES, STEPS, CALLS = 4096, 8, 16, 9
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


def in_python(model: dict[str, Any], rounds: list[dict[str, float]]) -> Any:
    batch = tumble.Batch(model, WORLDS)
    out = batch.states
    batch.step(120)

    def measure() -> None:
        plain, observed, reading = [], [], []
        for _ in range(CALLS):
            begun = time.perf_counter()
            batch.step(STEPS)
            stepped = time.perf_counter()
            batch.read_states(out)
            read = time.perf_counter()
            batch.step(STEPS, out=out)
            plain.append(stepped - begun)
            reading.append(read - stepped)
            observed.append(time.perf_counter() - read)
        found = {"python": plain, "read": reading, "python with out": observed}
        rounds[-1].update({name: statistics.median(times) for name, times in found.items()})

    return measure


def in_rust(program: str, model: dict[str, Any], threads: int, folder: Path, rounds: list[dict[str, float]]) -> Any:
    path = folder / "scene.json"
    path.write_text(json.dumps(model))
    command = [program, str(path), str(WORLDS), str(STEPS), str(CALLS), str(threads)]

    def measure() -> None:
        rounds[-1]["rust"] = float(subprocess.run(command, capture_output=True, text=True, check=True).stdout)

    return measure


def in_mujoco(on_plane: bool, threads: int, rounds: list[dict[str, float]]) -> Any:
    try:
        import mujoco
        from mujoco import rollout
    except ImportError:
        return None
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

    def measure() -> None:
        times = []
        for _ in range(3):
            begun = time.perf_counter()
            # Without its own pool: one that persists takes the cores from what is measured next.
            rollout.rollout(model, datas, starts, nstep=STEPS, state=states)
            times.append(time.perf_counter() - begun)
        rounds[-1][f"MuJoCo {mujoco.__version__} rollout"] = statistics.median(times)

    return measure


def main() -> None:
    program = sys.argv[1]
    threads, count = (int(text) for text in (sys.argv[2:] + ["2", "5"][len(sys.argv) - 2 :]))
    tumble.set_threads(threads)
    for on_plane in (False, True):
        rounds: list[dict[str, float]] = []
        with tempfile.TemporaryDirectory() as folder:
            model = scene(on_plane)
            parts = [
                in_python(model, rounds),
                in_rust(program, model, threads, Path(folder), rounds),
                in_mujoco(on_plane, threads, rounds),
            ]
            for _ in range(count):
                rounds.append({})
                for part in filter(None, parts):
                    part()
        print(f"{'on a plane' if on_plane else 'free'}, {threads} threads, {count} rounds")
        medians = {name: statistics.median(found[name] for found in rounds) for name in rounds[0]}
        for name, seconds in medians.items():
            rate = WORLDS * BODIES * STEPS / seconds / 1e6
            print(f"  {name:24} {1e3 * seconds:9.3f} ms a call{'' if name == 'read' else f' {rate:9.3f} M body-steps/s'}")
        ratio = statistics.median(found["rust"] / found["python"] for found in rounds)
        print(f"  Python reaches {100 * ratio:.1f} % of Rust; reading is {100 * medians['read'] / (medians['python'] / STEPS):.1f} % of a step")


if __name__ == "__main__":
    main()
