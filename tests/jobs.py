"""Long pieces of work as short as can be.

A job's process imports the module of its work: here nothing of the page, which would take seconds.
"""

import os
import time

from app.worker.job import Doing, Part, Send


def count_to(number: int, send: Send) -> int:
    for done in range(number):
        send(Doing(f"{done} done", done / number))
        send(Part(done))
    return number


def sleep(send: Send) -> None:
    send(Doing("asleep", 0.5))
    time.sleep(600.0)


def refuse(send: Send) -> None:
    raise ValueError("no such thing")


def vanish(send: Send) -> None:
    os._exit(1)
