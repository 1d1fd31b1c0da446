"""Files: tables, saved settings, results, and how they are read and written."""

from solver.files.saved import save_result, scene_settings, settings_from_toml

__all__ = ["save_result", "scene_settings", "settings_from_toml"]
