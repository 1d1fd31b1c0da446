"""Every scene with few bodies, as a page shows it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from bokeh.document import Document
from frames import arch, ran
from panel.io.state import set_curdoc
from pictures import frame_of, shown, small

from app.frame import Frame
from app.views.scene import HEIGHT, WIDTH, Scene
from app.views.type_size import TEXT
from solver.scenes import CATALOGUE


@pytest.fixture(autouse=True)
def document() -> Iterator[Document]:
    """A document whose page is being made."""
    made = Document()
    with set_curdoc(made):
        yield made


@pytest.fixture(scope="module", params=CATALOGUE)
def frame(request: pytest.FixtureRequest) -> Frame:
    """Frame of the second iterate of a scene."""
    return frame_of(small(request.param))


@pytest.fixture(scope="module")
def page_scene(frame: Frame) -> Scene:
    """The scene of a page that has shown the frame."""
    return shown(frame)


@pytest.fixture
def scene(page_scene: Scene) -> Scene:
    """The scene of that page, in its first size."""
    page_scene.magnify(TEXT)
    page_scene.lay_out(WIDTH, HEIGHT)
    page_scene.update(*page_scene._shown)  # type: ignore[misc]
    return page_scene


@pytest.fixture(scope="module")
def spread() -> Frame:
    """An arch whose abutments have moved apart."""
    settings = arch(displacement=1e-3, abutment_load="later", finish="at-once")
    return ran(settings)
