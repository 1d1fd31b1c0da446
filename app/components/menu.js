// Buttons with a small picture, and what opens below one.
const STROKES = {
  Undo: "M8 5L4 9L8 13M4 9H14A5 5 0 0 1 14 19H8",
  Redo: "M16 5L20 9L16 13M20 9H10A5 5 0 0 0 10 19H16",
  Runs: "M5 4V20M5 6H13V11H5M5 13H19V18H5",
  Class: "M8 9a3 3 0 1 0 0-6a3 3 0 0 0 0 6ZM2 20c0-5 2-8 6-8s6 3 6 8M15 4a3 3 0 0 1 0 6M17 13c3 1 4 3 4 7",
  Present: "M3 4H21V15H3ZM12 15V18M7 21L12 18L17 21",
  Share: "M12 15V3M8 7L12 3L16 7M6 11H4V21H20V11H18",
  "Take away": "M12 3V15M8 11L12 15L16 11M4 17V21H20V17",
}
const action = (name, title, more = {}) => {
  const picture = drawn("svg", {viewBox: "0 0 24 24", "aria-hidden": true})
  picture.append(drawn("path", {d: STROKES[name]}))
  const words = make("span", {}, say(name))
  return make("button", {type: "button", className: "action", title: say(title),
    ariaLabel: say(name), ...more},
    picture, words)
}
const menu = (name, title, ...content) => {
  const pane = make("div", {popover: "auto", className: "pane"}, ...content)
  pane.setAttribute("role", "group")
  pane.ariaLabel = say(name)
  const button = action(name, title, {popoverTargetElement: pane})
  pane.onbeforetoggle = () => {
    const {bottom, right} = button.getBoundingClientRect(), width = 300
    pane.style.top = `${bottom + 6}px`
    pane.style.right = `${Math.max(Math.min(innerWidth - right, innerWidth - width - 8), 8)}px`
  }
  return make("div", {className: "menu"}, button, pane)
}
