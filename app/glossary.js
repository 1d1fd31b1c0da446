// Shows what a term means beside it, while a pointer or the focus is on it; and what a control is
// for, while it has the focus of a keyboard: a pointer sees its title.
function glossary(terms) {
  const spelt = terms.flatMap(([all, line]) => all.map((one) => [one.toLowerCase(), line]))
  const lines = new Map(spelt), note = document.createElement("div")
  note.className = "glossary"
  note.setAttribute("role", "tooltip")
  Object.assign(note.style, {position: "fixed", zIndex: 1400, maxWidth: "340px", display: "none",
    padding: "6px 10px", borderRadius: "6px", font: "14px/1.4 system-ui, sans-serif",
    color: "#fff", background: "#263238", pointerEvents: "none"})
  document.body.append(note)
  let focused = null, home = null
  const written = (term) => term.textContent.toLowerCase()
  const line = (term) => lines.get(written(term)) ?? lines.get(written(term).replace(/s$/, ""))
  const met = (event) => event.composedPath().find((one) => one.tagName === "ABBR")
  const helped = (event) => event.composedPath()[0].matches(":focus-visible") &&
    event.composedPath().find((one) => one.title && /\bsetting-/.test(one.className))
  const hide = () => { note.style.display = "none" }
  const show = (term, text = line(term) ?? "") => {
    note.textContent = text
    note.style.display = text ? "block" : "none"
    const {left, top, bottom} = term.getBoundingClientRect()
    const {offsetWidth: wide, offsetHeight: tall} = note
    note.style.left = `${Math.max(Math.min(left, window.innerWidth - wide - 8), 8)}px`
    note.style.top = `${bottom + tall + 12 < window.innerHeight ? bottom + 6 : top - tall - 6}px`
  }
  const over = (event) => {
    const term = met(event) ?? focused
    term ? show(term) : hide()
  }
  // A picture that comes writes its words anew: the focus goes on to the same one.
  const keep = () => {
    if (!focused) { return }
    if (!focused.isConnected) {
      const same = [...home.querySelectorAll("abbr")].find((one) => written(one) === written(focused))
      focused = same ?? null
      same ? same.focus({preventScroll: true}) : hide()
    }
    requestAnimationFrame(keep)
  }
  const enter = (event) => {
    const term = met(event), was = focused
    focused = term ?? null
    const control = term ? null : helped(event)
    if (control) {
      event.composedPath()[0].ariaDescription = control.title
      return show(control, control.title)
    }
    if (!term) { return hide() }
    home = term.getRootNode()
    term.ariaDescription = line(term)
    show(term)
    if (!was) { requestAnimationFrame(keep) }
  }
  // Whatever is taken away loses the focus too, and only then is gone.
  const leave = () => {
    const was = focused
    requestAnimationFrame(() => {
      if (was?.isConnected && focused === was && home.activeElement !== was) {
        focused = null
        hide()
      }
    })
  }
  // Nor of a pointer that moves, or takes the focus away, inside of one component.
  const press = (event) => { if (!met(event)) { hide() } }
  const escape = (event) => { if (event.key === "Escape") { hide() } }
  // From one to another in the same component, nobody outside hears of the focus.
  const moved = (event) => { if (event.key === "Tab") { enter(event) } }
  const listeners = {
    pointerover: over, pointerdown: press, focusin: enter, focusout: leave, keydown: escape,
    keyup: moved,
  }
  for (const [name, does] of Object.entries(listeners)) { document.addEventListener(name, does) }
  return () => {
    note.remove()
    for (const [name, does] of Object.entries(listeners)) {
      document.removeEventListener(name, does)
    }
  }
}
