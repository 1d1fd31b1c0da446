export function render({model}) {
  const {tell, called, show: put, kinds} = controls(model)
  const NAMED = "the-named", OPENED = "slipfront-sheets"
  const root = make("div"), sheets = new Map()
  let rows = new Map(), pointed = ""
  const checks = (row, item) => {
    const list = make("div")
    row.show = ([options, value]) => list.replaceChildren(...options.map((name) => {
      const box = make("input", {type: "checkbox", checked: value.includes(name), name})
      box.onchange = () => tell(row,
        [...list.querySelectorAll("input:checked")].map((one) => one.name))
      return make("label", {}, box, " " + say(name))
    }))
    return [list]
  }
  const scenes = (row, item) => {
    const radios = item.options.map(([value]) =>
      make("input", {type: "radio", name: "scene", value, onchange: () => tell(row, value)}))
    const labels = item.options.map(([name, title, strokes], place) => {
      radios[place].ariaLabel = `${say(name)}: ${say(title)}`
      const picture = drawn("svg", {viewBox: "0 0 48 32", "aria-hidden": true})
      const kinds = ["ground", "body", "load"]
      picture.append(...strokes.map((d, kind) => drawn("path", {d, class: kinds[kind]})))
      return make("label", {title: say(title)}, radios[place], picture, say(name))
    })
    const group = called(item, make("div", {className: "scenes"}, ...labels))
    group.setAttribute("role", "radiogroup")
    row.show = (value) => { for (const one of radios) { one.checked = one.value === value } }
    return [group]
  }
  const note = (row) => {
    const words = make("p")
    row.show = (text) => { words.textContent = say(text) }
    return [words]
  }
  const table = (row, item) => {
    const send = async (file) => {
      if (file) { tell(row, [file.name, decoded(await file.arrayBuffer())]) }
    }
    const input = called(item, make("input", {type: "file", accept: ".csv,.txt"}))
    input.onchange = async () => {
      await send(input.files[0])
      input.value = ""
    }
    const name = make("b"), remove = make("button", {type: "button", className: "wide",
      title: say("Take them away."), onclick: () => tell(row, null)}, say("Remove"))
    const kept = make("div", {className: "typed"}, name, remove)
    const place = make("div", {}, make("label", {}, say(item.label), input), kept)
    // Dropped anywhere here, and not on the field alone.
    place.ondragover = (event) => event.preventDefault()
    place.ondrop = (event) => {
      event.preventDefault()
      send(event.dataTransfer.files[0])
    }
    row.show = (value) => {
      name.textContent = value
      kept.hidden = !value
    }
    return [place]
  }
  Object.assign(kinds, {checks, scenes, note, table})
  // Nouns of other languages may keep their capitals.
  const small = (text) => globalThis.slipfrontWords ? text : text.toLowerCase()
  const TYPED = "Enter types a value; Delete, or a double click, brings back the usual one."
  const helped = (item) => say(item.help || "") + (item.usual ? ` ${say(TYPED)}` : "")
  const added = (item) => {
    const written = JSON.stringify(item), kept = rows.get(item.name)
    if (kept && kept.written === written) { return kept }
    const row = {name: item.name, written, count: 0}
    row.box = make("div", {className: `setting-${item.name}`, title: helped(item)},
      ...kinds[item.kind](row, item))
    return row
  }
  // A browser may refuse to keep anything.
  const opened = () => {
    try { return JSON.parse(localStorage.getItem(OPENED)) ?? [] } catch { return [] }
  }
  const remember = () => {
    const open = [...sheets].filter(([, one]) => one.open).map(([title]) => title)
    try { localStorage.setItem(OPENED, JSON.stringify(open)) } catch {}
  }
  const sheet = (title) => {
    if (!sheets.has(title)) {
      const says = make("small"), head = make("summary", {}, say(title), says)
      const one = make("details", {className: "sheet", open: opened().includes(title)}, head)
      // One that words on the page have opened is not what somebody wants open from now on.
      head.onclick = () => setTimeout(remember)
      sheets.set(title, Object.assign(one, {head, says}))
    }
    return sheets.get(title)
  }
  let heads = []
  const build = () => {
    const made = new Map(), parts = []
    heads = []
    for (const one of sheets.values()) { one.replaceChildren(one.head) }
    for (const item of model.items) {
      const row = added(item), place = item.sheet ? sheet(item.sheet) : null
      made.set(item.name, row)
      if (place && !parts.includes(place)) { parts.push(place) }
      if (item.group && heads.at(-1)?.group !== item.group) {
        heads.push(Object.assign(make("h4", {}, say(item.group)), {group: item.group, rows: []}))
        place ? place.append(heads.at(-1)) : parts.push(heads.at(-1))
      }
      if (item.group) { heads.at(-1).rows.push(row.box) }
      place ? place.append(row.box) : parts.push(row.box)
    }
    rows = made
    root.replaceChildren(...parts)
    show()
  }
  const show = () => {
    put(rows)
    for (const head of heads) { head.hidden = head.rows.every((box) => box.hidden) }
    for (const one of sheets.values()) {
      const seen = heads.filter((head) => head.parentNode === one && !head.hidden)
      one.hidden = !seen.length
      one.says.textContent = seen.map((head) => small(say(head.group))).join(", ")
    }
    point(model.shown[NAMED] ?? [])
  }
  const point = (names) => {
    const now = JSON.stringify(names)
    if (now === pointed) { return }
    pointed = now
    for (const name of names) {
      const place = rows.get(name)?.box.closest("details")
      if (place) { place.open = true }
    }
  }
  model.on("items", build)
  model.on("shown", show)
  build()
  return root
}
