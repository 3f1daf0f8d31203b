"""Campaigns on a Dask cluster, by the address of its scheduler; Dask is an optional package."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from voussoir.campaign import part
from voussoir.campaign.part import Part, run_part
from voussoir.campaign.share import Engine, Outcome
from voussoir.dda_program import DdaError
from voussoir.extras import advice

#: How long a scheduler may take to answer [s]
WAIT = 30.0


def dask_engine(address: str) -> tuple[Engine, int]:
    """Workers of a Dask cluster by its scheduler's address, such as tcp://10.0.0.1:8786; and the number of its threads.

    A part whose worker dies is run again by another; DdaError if Dask is not installed, or no scheduler answers.
    """
    try:
        import cloudpickle
        from distributed import Client, as_completed
    except ImportError as error:
        raise DdaError(
            f"--scheduler:1: error: expected Dask, got none ({error}); {advice('distributed')}, or omit --scheduler"
        ) from error
    try:
        client = Client(address, timeout=WAIT)
    except (OSError, ValueError) as error:
        raise DdaError(
            f"--scheduler:1: error: expected a Dask scheduler at {address}, got none "
            f"({error}); start one with 'dask scheduler', or correct the address"
        ) from error
    # by value: the workers need not have this package
    cloudpickle.register_pickle_by_value(part)

    def task(part: dict[str, Any]) -> Outcome:
        return run_part(Part(**part))

    def run(parts: list[Part]) -> Iterator[Outcome]:
        with client:
            # a killed worker is the part's own fault only if it happens again and again
            futures = client.map(task, [vars(part) for part in parts], pure=False, retries=10)
            for future in as_completed(futures):
                if future.status == "finished":
                    yield future.result()
                else:
                    yield 3, f"a part was given up by the cluster: {future.exception()!r}"

    return run, max(1, sum(client.nthreads().values()))
