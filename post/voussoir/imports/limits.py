"""Work on files of others in a process with limits of time and memory."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from typing import Any

from voussoir.dda_program import DdaError
from voussoir.extras import MissingPackage

#: Processor time of the work [s]
MOST_SECONDS = 7
#: Elapsed time after which the work is ended in any case [s]: a loaded machine gets several times the processor time
MOST_ELAPSED = 30
#: Address space of the work [bytes]
MOST_MEMORY = 10**9


def limited(function: Callable[..., Any], *arguments: Any) -> Any:
    """Call a function in a process of its own and return its value.

    A failure becomes a ValueError whose message has one line; MissingPackage and DdaError stay what they are.
    """
    words = [sys.executable, "-c", "from voussoir.imports.limits import work; work()"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path)), "OPENBLAS_NUM_THREADS": "1"}
    try:
        done = subprocess.run(
            words, input=pickle.dumps((function, arguments)), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
            timeout=MOST_ELAPSED, env=environment)
    except subprocess.TimeoutExpired:
        raise ValueError(_too_large()) from None
    if done.returncode != 0 or not done.stdout:
        raise ValueError(_too_large())
    value, failure = pickle.loads(done.stdout)
    if failure:
        raise failure
    return value


def work() -> None:
    """Do what standard input asks for, within the limits, and write the result to standard output."""
    answer = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # libraries may print
    _set_limits()
    function, arguments = pickle.loads(sys.stdin.buffer.read())
    value: Any = None
    failure: Exception | None = None
    try:
        value = function(*arguments)
    except (MissingPackage, DdaError) as problem:
        failure = problem
    except MemoryError:
        failure = ValueError(_too_large())
    except RecursionError:
        failure = ValueError("expected a file of few levels, got one nested too deeply")
    except OSError as problem:
        failure = ValueError(f"expected a file that can be read, got: {problem.strerror or one_line(problem)}")
    except ValueError as problem:
        failure = ValueError(one_line(problem))
    except Exception as problem:  # a fault of a reader is no traceback for the user
        failure = ValueError(f"expected a file of its kind, got a {type(problem).__name__}: {one_line(problem)}")
    pickle.dump((value, failure), answer)
    answer.close()


def one_line(problem: object) -> str:
    """The first line of a message that has words, without control characters."""
    lines = [line.strip() for line in str(problem).splitlines() if line.strip()]
    return "".join(sign if sign.isprintable() else "?" for sign in (lines or [type(problem).__name__])[0])[:1000]


def _set_limits() -> None:
    """Limit this process; systems without such limits have the elapsed time alone."""
    try:
        import resource
    except ImportError:
        return
    for kind, most in ((resource.RLIMIT_CPU, MOST_SECONDS), (resource.RLIMIT_AS, MOST_MEMORY)):
        hard = resource.getrlimit(kind)[1]
        resource.setrlimit(kind, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


def _too_large() -> str:
    """The message for a file that exceeds a limit."""
    return (
        f"expected a file that is read within {MOST_SECONDS} s and {MOST_MEMORY / 1e9:g} GB, got a larger one; "
        "import parts of it")
