// Shows what a term means beside it, while a pointer or the focus of a keyboard is on it, or once it
// is tapped; and what a control is for, while it has that focus: a pointer sees its title.
// Of a way between two elements of one component nobody outside hears. So a pointer is followed by
// its moves, which have no end of a way, and the focus is looked for.
function glossary(terms) {
  const spelt = terms.flatMap(([all, line]) => all.map((one) => [one.toLowerCase(), line]))
  const lines = new Map(spelt), note = document.createElement("div")
  note.className = "glossary"
  note.setAttribute("role", "tooltip")
  Object.assign(note.style, {position: "fixed", zIndex: 1400, maxWidth: "340px", display: "none",
    padding: "6px 10px", borderRadius: "6px", font: "14px/1.4 system-ui, sans-serif",
    color: "#fff", background: "#263238", pointerEvents: "none"})
  document.body.append(note)
  let pointed = null, place = [0, 0], focused = null, home = null, dismissed = "", frame = 0
  const written = (term) => term.textContent.toLowerCase()
  const line = (term) => lines.get(written(term)) ?? lines.get(written(term).replace(/s$/, ""))
  const said = (one) => (one.tagName === "ABBR" ? line(one) : one.title) ?? ""
  const among = (path) => path.find((one) => one.tagName === "ABBR") ?? null
  const active = () => innermost(document, (root) => root.activeElement)
  const put = () => {
    const one = pointed ?? focused, text = one ? said(one) : ""
    if (text !== dismissed) { dismissed = "" }
    const shown = dismissed ? "" : text
    if (note.textContent !== shown) { note.textContent = shown }
    note.style.display = shown ? "block" : "none"
    if (!shown) { return }
    const {left, top, bottom} = one.getBoundingClientRect()
    const {offsetWidth: wide, offsetHeight: tall} = note
    note.style.left = `${Math.max(Math.min(left, window.innerWidth - wide - 8), 8)}px`
    note.style.top = `${bottom + tall + 12 < window.innerHeight ? bottom + 6 : top - tall - 6}px`
  }
  // A picture that comes writes its words anew: pointer and focus go on to what stands there now.
  const renew = () => {
    if (pointed && !pointed.isConnected) { pointed = among(around(beneath(...place))) }
    if (!focused || focused.isConnected) { return }
    const was = written(focused)
    focused = [...home.querySelectorAll("abbr")].find((one) => written(one) === was) ?? null
    focused?.focus({preventScroll: true})
  }
  const follow = () => {
    renew()
    put()
    frame = pointed || focused ? requestAnimationFrame(follow) : 0
  }
  const settle = () => { if (!frame) { follow() } else { put() } }
  const point = (event, term) => {
    place = [event.clientX, event.clientY]
    if (term === pointed) { return }
    pointed = term
    settle()
  }
  const focus = () => {
    const one = active(), path = around(one), term = among([one ?? document])
    const isVisible = one?.matches(":focus-visible")
    const control = path.find((each) => each.title && /\bsetting-/.test(each.className))
    const found = isVisible ? term ?? control ?? null : null
    if (found) {
      home = found.getRootNode()
      one.ariaDescription = said(found)
    }
    if (found === focused) { return }
    focused = found
    settle()
  }
  const met = (event) => among(event.composedPath())
  const move = (event) => { if (event.pointerType !== "touch") { point(event, met(event)) } }
  const press = (event) => {
    const isTouch = event.pointerType === "touch"
    focused = null
    point(event, isTouch ? null : met(event))
  }
  const tap = (event) => { if (event.detail) { point(event, met(event)) } }
  const depart = (event) => { if (!event.relatedTarget) { point(event, null) } }
  const turn = (event) => point(event, null)
  const type = (event) => {
    if (event.key !== "Escape") { return }
    dismissed = note.textContent
    put()
  }
  // What is taken away loses the focus too, and only then is gone.
  const leave = () => requestAnimationFrame(() => { if (!focused || focused.isConnected) { focus() } })
  const listeners = {
    pointermove: move, pointerdown: press, click: tap, pointerout: depart, wheel: turn,
    focusin: focus, focusout: leave, keydown: type, keyup: focus,
  }
  for (const [name, does] of Object.entries(listeners)) {
    document.addEventListener(name, does, {passive: true})
  }
  return () => {
    note.remove()
    pointed = focused = null
    for (const [name, does] of Object.entries(listeners)) { document.removeEventListener(name, does) }
  }
}
