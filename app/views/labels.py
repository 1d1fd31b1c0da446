"""Labels in the picture of a scene: loads, and the slope.

Anchors of words are px of the figure; the picture's own lines are px from the middle of
the foot.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.views.acts import Arrows, anchor_of, color_of, text_of
from app.views.colors import FORCE
from app.views.layout import EACH, FOOTING, is_opposite
from app.views.obstacles import ALONG, Obstacles
from app.views.picture import Columns, Picture
from app.views.words import Word, around, box_of, inside, meets
from solver.arrays import Array
from solver.discrete.structure import Act
from solver.files.amounts import number

FAR = 1.5
"""Distance of words of a weight from its arrow, over that of rows, from which on a line
leads there."""
MOST_ROWS = 3
"""Largest number of rows by which a word makes way for others, bodies and ground."""


def labels_of(picture: Picture) -> tuple[Columns, Columns]:
    """Columns of all labels on a picture, and of leader lines to distant arrows.

    Words are moved off each other and off arrows.
    """
    obstacles = Obstacles(picture)
    words = _words_of_loads(picture, obstacles)
    if picture.description.tilt is not None:
        words.append(_slope(picture))
    words = _apart(inside(picture.layout, words), obstacles)
    x, y = np.reshape([word.anchor for word in words], (-1, 2)).T
    columns = {
        "x": x,
        "y": y,
        "text": [word.text for word in words],
        "text_align": [word.align for word in words],
        "text_color": [word.color for word in words],
    }
    return columns, _leaders(words, obstacles)


def _words_of_loads(picture: Picture, obstacles: Obstacles) -> list[Word]:
    """Symbols and values of the loads."""
    layout = picture.layout
    words = []
    rows = 0
    for arrows, count in zip(picture.arrows, layout.equals, strict=True):
        act = arrows.act
        # Pressures from both sides have one text, and so have equal loads.
        if _is_repeated(act, picture.description.acts) or count == 0:
            continue
        word = _word_of_load(picture, arrows, count)
        if layout.angle or layout.is_told_above(act, count):
            above = layout.canvas.height - (rows + 0.5) * layout.row
            anchor = np.array([layout.origin[0], above])
            word = word._replace(anchor=anchor, align="center")
            rows += 1
        elif act.side == "body" and len(arrows.lines):
            word = _beside(word, picture.page(arrows.lines[0]), obstacles)
        words.append(word)
    return words


def _word_of_load(picture: Picture, arrows: Arrows, count: int) -> Word:
    """Symbol and value of a load, or of a number of equal ones, at its arrows."""
    act = arrows.act
    layout = picture.layout
    text = text_of(act, picture.now)
    anchor, align = anchor_of(arrows, layout)
    if count > 1:
        text += EACH
        if act.side in ("left", "right"):
            anchor = np.array([0.0, -FOOTING - 0.6 * layout.row])
            align = "center"
    return Word(text, picture.page(anchor), align, color_of(act))


def _is_repeated(act: Act, acts: Sequence[Act]) -> bool:
    """Check whether a load is a pressure from below that has its label above."""
    if not act.where.startswith("bottom"):
        return False
    above = [other for other in acts if other.where.startswith("top")]
    return any(is_opposite(act, other) for other in above)


def _beside(word: Word, line: Array, obstacles: Obstacles) -> Word:
    """A label next to an upright arrow, (n, 2), px, or below, if there is room.

    Below an arch, say, there is room at the arrow itself. An arrow on bodies ends
    at the ground, where there is none.
    """
    middle = line.mean(axis=0)
    if obstacles.has_bodies_below(word._replace(text="", anchor=middle)):
        return word
    foot = line[line[:, 1].argmin()]
    aside = np.array([12.0, 0.0])
    below = np.array([0.0, -8.0 - obstacles.layout.row])
    places = [
        word._replace(anchor=middle + aside, align="left"),
        word._replace(anchor=middle - aside, align="right"),
        word._replace(anchor=foot + below, align="center"),
    ]
    free = [place for place in places if not any(obstacles.below(place))]
    return next(iter(free), word)


def _leaders(words: Sequence[Word], obstacles: Obstacles) -> Columns:
    """Leader lines from labels of a weight to the tails of its distant arrows.

    None where the line would lie on other words or arrows.
    """
    columns: Columns = {"xs": [], "ys": []}
    for word in words:
        line = _leader(word, obstacles)
        others = [other for other in words if other is not word]
        if len(line) and not _is_cut(line, others, obstacles):
            columns["xs"].append(line[:, 0].tolist())
            columns["ys"].append(line[:, 1].tolist())
    return columns


def _leader(word: Word, obstacles: Obstacles) -> Array:
    """Line from words of a weight to the tail of its arrow, (2, 2), px.

    It has no points where other words are given, or the arrow is near.
    """
    layout = obstacles.layout
    arrow = obstacles.weights.get(word.text)
    if arrow is not None:
        # From the points of the words that are nearest to those of the arrow.
        nearest = np.clip(arrow, *box_of(layout, word))
        if np.hypot(*(arrow - nearest).T).min() >= FAR * layout.row:
            begin = nearest[0]
            tail = arrow[0]
            if begin[1] != tail[1]:
                # On a page that is saved words are narrower: they keep their anchor.
                begin[0] = word.anchor[0]
            return np.stack([begin, tail])
    return np.zeros((0, 2))


def _is_cut(line: Array, others: Sequence[Word], obstacles: Obstacles) -> bool:
    """Check whether other words or handles lie on a line, (2, 2), px, or (0, 2)."""
    if not len(line):
        return False
    shares = np.linspace(0.1, 0.9, ALONG)[:, None]
    return obstacles.block(line[0] + shares * (line[1] - line[0]), others)


def _slope(picture: Picture) -> Word:
    """Label of the angle of tilted bodies, at the horizontal below their foot."""
    layout = picture.layout
    side = 1.0
    align = "left"
    if picture.tilt < 0.0:
        side = -1.0
        align = "right"
    text = f"slope {number(float(np.degrees(picture.tilt)))}°"
    _, end = picture.horizontal
    # Lower than the ground, which ends beside it where it hardly tilts.
    anchor = picture.page(end) + np.array([8.0 * side, -0.5 * layout.row])
    return Word(text, anchor, align, FORCE)


def _apart(words: Sequence[Word], obstacles: Obstacles) -> list[Word]:
    """Labels, moved up, down or aside, off earlier ones, arrows, bodies and ground.

    They go to the next place that is free, and from which a line may lead to an arrow
    that is far; where there is none, arrows come before bodies.
    """
    layout = obstacles.layout
    placed: list[Word] = []
    for index, word in enumerate(words):
        others = [*placed, *words[index + 1 :]]

        def burden(place: Word, others: Sequence[Word] = others) -> tuple[bool, ...]:
            is_cut = _is_cut(_leader(place, obstacles), others, obstacles)
            return *obstacles.below(place), is_cut

        chosen = word
        if meets(layout, word, placed) or any(burden(word)):
            places = [word, *around(layout, word, MOST_ROWS)]
            free = [one for one in places if not meets(layout, one, placed)]
            # Without a place that is free of all, the one with the least burden.
            unburdened = (one for one in free if not any(burden(one)))
            chosen = next(unburdened, None) or min(free, key=burden, default=word)
        placed.append(chosen)
    return placed
