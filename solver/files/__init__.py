"""Files: tables, saved settings, results, and how they are read and written."""

from solver.files.results import save_result
from solver.files.saved import scene_settings, settings_from_toml

__all__ = ["save_result", "scene_settings", "settings_from_toml"]
