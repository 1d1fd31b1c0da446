"""Long reports as short as can be.

A report's process imports the module of its work: here nothing of the page, which would take
seconds.
"""

import os
import time
from pathlib import Path

from app.session.report_folder import ReportFolder


def count_to(number: int, folder: Path) -> None:
    growing = ReportFolder(folder)
    for done in range(number):
        growing.tell(f"{done} done", done / number)
        growing.show([f"<p>{done}</p>"])
        growing.publish(lambda place, done=done: (place / "counted.csv").write_text(f"{done}\n"))


def sleep(folder: Path) -> None:
    ReportFolder(folder).tell("asleep", 0.5)
    time.sleep(600.0)


def refuse(folder: Path) -> None:
    raise ValueError("no such thing")


def vanish(folder: Path) -> None:
    os._exit(1)
