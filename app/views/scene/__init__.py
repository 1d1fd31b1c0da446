"""The living picture of what is solved; all is in pixels of the figure, computed here.

A layout brings bodies onto the screen, `outlines`, `holds` and `acts` draw them, what holds them
and what acts on them from a `Description`, and `scene` shows that.
"""

from app.views.scene.scene import Scene

__all__ = ["Scene"]
