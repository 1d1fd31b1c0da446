export function render({model}) {
  const {tell, named, show: put, kinds} = controls(model)
  const root = make("div")
  let rows = new Map()
  const checks = (row, item) => {
    const list = make("div")
    row.show = ([options, value]) => list.replaceChildren(...options.map((name) => {
      const box = make("input", {type: "checkbox", checked: value.includes(name), name})
      box.onchange = () => tell(row,
        [...list.querySelectorAll("input:checked")].map((one) => one.name))
      return make("label", {}, box, " " + name)
    }))
    return [list]
  }
  const share = (row, item) => {
    const text = (bytes) => {
      try { return new TextDecoder("utf-8", {fatal: true}).decode(bytes) } catch {}
      // Spreadsheets write letters as old Windows did; no text has zeros.
      const isText = !new Uint8Array(bytes).includes(0)
      return isText ? new TextDecoder("windows-1252").decode(bytes) : null
    }
    const upload = named(item, make("input", {type: "file", accept: ".toml,.csv"}))
    upload.onchange = async () => {
      const [file] = upload.files
      if (file) { tell(row, [file.name, text(await file.arrayBuffer())]) }
      upload.value = ""
    }
    const buttons = item.buttons.map(([name, title]) =>
      make("button", {title, className: "wide", onclick: () => tell(row, name)}, name))
    row.show = () => {}
    return [...buttons, make("label", {}, item.label, upload)]
  }
  const note = (row) => {
    const words = make("p")
    row.show = (text) => { words.textContent = text }
    return [words]
  }
  Object.assign(kinds, {checks, share, note})
  const helped = (item) => (item.help || "") +
    (item.usual ? " Double click, or Delete, brings back the usual value." : "")
  const added = (item) => {
    const written = JSON.stringify(item), kept = rows.get(item.name)
    if (kept && kept.written === written) { return kept }
    const row = {name: item.name, written, count: 0}
    row.box = make("div", {className: `setting-${item.name}`, title: helped(item)},
      ...kinds[item.kind](row, item))
    return row
  }
  const heads = []
  const build = () => {
    const open = root.querySelector("details")?.open
    const more = make("details", {open}, make("summary", {}, "More settings"))
    const made = new Map(), parts = []
    heads.length = 0
    more.rows = []
    for (const item of model.items) {
      const row = added(item)
      made.set(item.name, row)
      if (item.more) {
        if (!parts.includes(more)) { parts.push(more) }
        more.append(row.box)
        more.rows.push(row.box)
        continue
      }
      if (item.group && heads.at(-1)?.textContent !== item.group) {
        heads.push(make("h4", {}, item.group))
        heads.at(-1).rows = []
        parts.push(heads.at(-1))
      }
      if (item.group) { heads.at(-1).rows.push(row.box) }
      parts.push(row.box)
    }
    if (parts.includes(more)) { heads.push(more) }
    rows = made
    root.replaceChildren(...parts)
    show()
  }
  const show = () => {
    put(rows)
    for (const head of heads) { head.hidden = head.rows.every((box) => box.hidden) }
  }
  model.on("file", () =>
    save("slipfront.toml", new Blob([model.file[0]], {type: "application/toml"})))
  model.on("items", build)
  model.on("shown", show)
  build()
  return root
}
