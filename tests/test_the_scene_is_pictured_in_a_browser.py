"""The picture of the scene and the load path on a page: alive, and ways to choose."""

from __future__ import annotations

from pages import Visit, card, status
from playwright.sync_api import Page, expect


def place(page: Page, name: str, share: float) -> tuple[float, float]:
    """Give a place on a plot's frame, at a share of its width and half of its height."""
    found = card(page, name).locator(".bk-Figure, .bk-Plot, canvas").first.bounding_box()
    assert found is not None
    return found["x"] + share * found["width"], found["y"] + 0.5 * found["height"]


def test_an_instant_is_chosen_on_the_load_path_and_the_picture_follows(open_page: Visit) -> None:
    page = open_page("?elements=20&substructures=4")
    expect(status(page)).to_contain_text("converged")
    expect(page.get_by_text("Load path").last).to_be_visible()
    words = "() => Bokeh.documents[0].get_model_by_name('scene.words').data.text.join()"
    page.wait_for_function(f"({words})().includes('F = −0.9 kN')")
    page.mouse.click(*place(page, "Load path", 0.4))
    page.wait_for_function(f"({words})().includes('F = 0.')")
    expect(page.get_by_text("Instant").first).not_to_contain_text("0.75")


def test_a_tap_on_the_picture_chooses_the_substructure(open_page: Visit) -> None:
    page = open_page("?linear_stage=pgd&elements=20&substructures=4&pressure=0")
    expect(status(page)).to_contain_text("iteration")
    page.wait_for_function(
        "() => (Bokeh.documents[0].get_model_by_name('scene.bodies')?.data.xs || []).length"
    )
    where = page.evaluate(
        """() => {
          const {xs, ys, value} = Bokeh.documents[0].get_model_by_name("scene.bodies").data
          const figure = [...Bokeh.documents[0].all_models].find(
            (one) => one.type === "Plot" && one.x_range.name === "scene.x")
          const view = Bokeh.index.find_one_by_id(figure.id)
          const {x, y} = view.el.getBoundingClientRect()
          const at = [...value].findIndex((part) => part === 1)
          const middle = (ends) => ends.reduce((a, b) => a + b) / ends.length
          const {x_scale, y_scale} = view.frame
          return [
            x + x_scale.compute(middle([...xs[at]])), y + y_scale.compute(middle([...ys[at]]))]
        }"""
    )
    page.mouse.click(*where)
    expect(page.get_by_role("slider", name="Substructure", exact=True)).to_have_value("2")
