"""Promise: no call with odd arguments crashes or panics."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import ModuleType

SCRIPT = Path(__file__).parent / "odd_calls.py"
SEED, SECONDS = 20260101, 3


def test_no_call_with_odd_arguments_ends_the_process(lib: ModuleType) -> None:
    command = [sys.executable, str(SCRIPT), lib.__name__, str(SEED), str(SECONDS)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr[-4000:]
    calls, refused = map(int, done.stdout.split())
    # Both kinds of calls are among them.
    assert calls > 100 and 0.1 < refused / calls < 0.9
