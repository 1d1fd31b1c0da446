"""Colours that mean something; all can be told apart by the colour-blind (Okabe and Ito)."""

LATIN = "#0072B2"
REFERENCE = "#7A7A7A"
ERROR = "#D55E00"
DISPLACEMENT = "#009E73"
EXACT = "#56B48C"
GHOST = "#9A9A9A"
FORCE = "#D55E00"
STICK, FORWARD, BACKWARD, OPENED = "#C9CDD1", "#E69F00", "#0072B2", "#4D4D4D"
STATUS = {-1: BACKWARD, 0: STICK, 1: FORWARD, 2: OPENED}
BODY, EDGE = "#8FAAC2", "#607D8B"
