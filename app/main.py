"""What `panel serve app` runs for every page that is opened."""

import sys
from pathlib import Path

root = str(Path(__file__).resolve().parents[1])
if root not in sys.path:
    sys.path.insert(0, root)

from app.page import open_page  # noqa: E402  # the root is on the path only from here on

open_page().servable()
