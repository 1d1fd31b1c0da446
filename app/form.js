export function render({model}) {
  const root = document.createElement("div")
  let rows = new Map(), count = 0
  const make = (tag, more = {}, ...children) => {
    const made = Object.assign(document.createElement(tag), more)
    made.append(...children)
    return made
  }
  const tell = (row, value, hand = false) => {
    row.count = count += 1
    model.send_msg({name: row.name, value, hand, count})
  }
  const written = (value, item) => {
    const rounded = Number(value.toPrecision(item.log ? 3 : 4)), size = Math.abs(rounded)
    if (size === 0 || (size >= 1e-3 && size < 1e5)) { return rounded.toString() }
    const [digits, power] = rounded.toExponential().split("e")
    const raised = [...power.replace("+", "")].map((one) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[one] ?? "⁻").join("")
    return (digits === "1" ? "" : digits + "·") + "10" + raised
  }
  const named = (item, input) => {
    input.ariaLabel = item.label
    return input
  }
  const filled = (select, options, value) => {
    select.replaceChildren(...options.map(([text, value]) => new Option(text, value)))
    select.value = value
  }
  const slider = (row, item) => {
    const step = item.whole && !item.log ? 1 : "any"
    const range = named(item, make("input", {type: "range", step}))
    const text = make("output")
    let {start, end} = item
    const place = (value) => item.log ? Math.log10(value) : value
    const read = () => {
      let value = item.log ? 10 ** range.valueAsNumber : range.valueAsNumber
      if (item.whole) { value = Math.round(value) }
      else if (item.log) { value = Number(value.toPrecision(4)) }
      else { value = Number((Math.round(value / item.step) * item.step).toPrecision(12)) }
      return Math.min(Math.max(value, start), end)
    }
    const say = (value) => {
      text.textContent = range.ariaValueText = written(value, item)
      range.ariaValueNow = value
    }
    let last
    range.oninput = () => {
      if (read() === last) { return }
      say(last = read())
      tell(row, last, true)
    }
    range.onchange = () => tell(row, null)
    row.show = (value) => {
      start = Math.min(start, value)
      end = Math.max(end, value)
      range.min = place(start)
      range.max = place(end)
      // Between two whole numbers a logarithmic slider would never leave the lower one.
      if (read() !== value || last === undefined) { range.value = place(value) }
      say(last = value)
    }
    return [make("label", {}, item.label + ": ", text), range]
  }
  const choice = (row, item) => {
    const select = named(item, make("select", {onchange: () => tell(row, select.value)}))
    filled(select, item.options)
    row.show = (value) => { select.value = value }
    return [make("label", {}, item.label), select]
  }
  const flip = (row, item) => {
    const box = make("input", {type: "checkbox", onchange: () => tell(row, box.checked)})
    box.setAttribute("role", "switch")
    row.show = (value) => { box.checked = value }
    return [make("label", {}, box, " " + item.label)]
  }
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
  const curve = (row, item) => {
    const parts = choice(row, item), show = row.show
    const body = make("tbody"), head = make("tr")
    head.append(...[...item.columns, "", ""].map((one) => make("td", {}, one)))
    const table = make("div", {className: "points"},
      make("table", {}, make("thead", {}, head), body))
    const read = () => [...body.rows].map((one) =>
      [...one.querySelectorAll("input")].map((input) => input.valueAsNumber))
    const send = (rows) => {
      if (rows.every((one) => one.every(Number.isFinite))) { tell(row, rows) }
    }
    const number = (value) => make("input", {
      type: "number", step: "any", required: true, value, onchange: () => send(read()),
    })
    const added = (place) => {
      const points = read(), [x, y] = points[place], next = points[place + 1]
      const last = place > 0 ? x - points[place - 1][0] : 1
      const more = next ? [(x + next[0]) / 2, (y + next[1]) / 2] : [x + last, y]
      send(points.toSpliced(place + 1, 0, more))
    }
    const taken = (place) => {
      if (body.rows.length > 1) { send(read().toSpliced(place, 1)) }
    }
    const button = (text, title, onclick) => make("button", {title, onclick}, text)
    const line = (pair, place) => make("tr", {}, ...[
      ...pair.map(number),
      button("+", "Add a row below", () => added(place)),
      button("−", "Take this row away", () => taken(place)),
    ].map((one) => make("td", {}, one)))
    row.show = (value) => {
      const points = Array.isArray(value) ? value : []
      show(points.length ? item.options.at(-1)[1] : value)
      table.hidden = !points.length
      if (JSON.stringify(read()) !== JSON.stringify(points)) {
        body.replaceChildren(...points.map(line))
      }
    }
    return [...parts, table]
  }
  const share = (row, item) => {
    const text = (bytes) => {
      try { return new TextDecoder("utf-8", {fatal: true}).decode(bytes) }
      catch { return null }
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
  const kinds = {slider, choice, flip, checks, curve, share}
  const added = (item) => {
    const written = JSON.stringify(item), kept = rows.get(item.name)
    if (kept && kept.written === written) { return kept }
    const row = {name: item.name, written, count: 0}
    row.box = make("div", {className: `setting-${item.name}`, title: item.help || ""},
      ...kinds[item.kind](row, item))
    return row
  }
  const heads = []
  const build = () => {
    const open = root.querySelector("details")?.open
    const more = make("details", {open}, make("summary", {}, "More settings"))
    const made = new Map(), parts = []
    heads.length = 0
    for (const item of model.items) {
      const row = added(item)
      made.set(item.name, row)
      if (item.more) {
        if (!parts.includes(more)) { parts.push(more) }
        more.append(row.box)
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
    rows = made
    root.replaceChildren(...parts)
    show()
  }
  const show = () => {
    const obeyed = model.shown[""]
    for (const [name, row] of rows) {
      row.box.hidden = !(name in model.shown)
      if (!row.box.hidden && row.count <= obeyed) { row.show(model.shown[name]) }
    }
    for (const head of heads) { head.hidden = head.rows.every((box) => box.hidden) }
  }
  model.on("file", () => {
    const href = URL.createObjectURL(new Blob([model.file[0]], {type: "application/toml"}))
    make("a", {href, download: "slipfront.toml"}).click()
    setTimeout(() => URL.revokeObjectURL(href), 1e4)
  })
  model.on("items", build)
  model.on("shown", show)
  build()
  return root
}
