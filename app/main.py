"""The script that `panel serve app` runs for every page that is opened."""

import sys
from pathlib import Path

# It is as it was again once this has run.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from app.page import open_page  # the root is on the path only from here on

open_page().servable()
