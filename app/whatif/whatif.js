const NAME = "what-if"
const filled = (select, options, value) => {
  const all = options.some(([one]) => one === value) ? options : [...options, [value, value]]
  const text = JSON.stringify(all)
  if (select.text !== text) {
    select.text = text
    select.replaceChildren(...all.map(([name, title]) => new Option(title, name)))
  }
  select.value = value
}
// What somebody is typing stays as it is until it is told.
const put = (input, value) => {
  if (input.getRootNode().activeElement !== input || !input.typed) { input.value = value }
}
const typed = (className, ariaLabel, tell) => {
  const input = make("input", {className, ariaLabel})
  input.oninput = () => { input.typed = true }
  input.onchange = () => { input.typed = false; tell() }
  return input
}
// The fields of one setting and its values.
const spanned = (place, heading, tell) => {
  const shown = {}
  const send = (more = {}) => tell("span", {place, span: {name: select.value, low: low.value,
    high: high.value, count: count.value, spacing: spacing.value, listed: listed.value, unit: unit.textContent,
    ...more}})
  const label = (words) => `${heading}: ${words}`
  const select = make("select", {ariaLabel: label("setting"), onchange: () => send()})
  const low = typed("low", label("from"), send), high = typed("high", label("to"), send)
  const count = typed("count", label("how many values"), send)
  const listed = typed("listed", label("values, commas between them"), send)
  const spacing = make("select", {ariaLabel: label("spacing"), onchange: () => send()})
  filled(spacing, [["even", "even steps"], ["log", "even ratios"], ["list", "a list"]], "even")
  const names = make("span"), refused = make("span", {className: "refused", role: "alert"})
  const unit = make("span"), own_unit = make("span")
  const parts = [low, "to", high, unit, "in", count, "values,"].map((one) =>
    typeof one === "string" ? make("span", {}, one) : one)
  const row = make("div", {className: "row"}, make("b", {}, heading), select, ...parts, listed, own_unit,
    spacing, names, refused)
  shown.row = row
  shown.show = (form) => {
    const span = form.spans[place] ?? {name: "", spacing: "even"}
    const own = form.settings.find(({name}) => name === span.name)
    const options = form.settings.map((one) => [one.name, one.title])
    filled(select, place ? [["", "nothing else"], ...options] : options, span.name)
    const isNamed = Boolean(own?.of.length), isListed = span.spacing === "list"
    for (const one of parts) { one.hidden = !span.name || isListed }
    listed.hidden = own_unit.hidden = !span.name || !isListed || isNamed
    unit.textContent = own_unit.textContent = span.unit ?? ""
    spacing.hidden = !span.name || isNamed
    names.hidden = !isNamed
    spacing.value = span.spacing
    const values = [[low, span.low], [high, span.high], [count, span.count], [listed, span.listed]]
    for (const [input, value] of values) { put(input, value ?? "") }
    refused.textContent = form.refusals[place] ?? ""
    const chosen = (span.listed ?? "").split(",")
    names.replaceChildren(...(own?.of ?? []).map((name) => {
      const box = make("input", {type: "checkbox", checked: chosen.includes(name), name})
      box.onchange = () => send({listed: [...names.querySelectorAll("input:checked")]
        .map((one) => one.name).join()})
      return make("label", {}, box, ` ${name} `)
    }))
  }
  return shown
}
export function render({model}) {
  const tell = (kind, value = null) => model.send_msg({kind, value})
  const spans = [spanned(0, "Over", tell), spanned(1, "and over", tell)]
  const ready = make("div", {className: "row"})
  const ask = () => tell("quantity", {name: quantity.value, at: at.value})
  const quantity = make("select", {ariaLabel: "Quantity", onchange: () => { at.value = ""; ask() }})
  const at = typed("at", "Its parameter", ask)
  const words = make("span"), refused = make("span", {className: "refused", role: "alert"})
  const button = (text, title, onclick) => make("button", {title, onclick}, text)
  const start = button("Start", "Run all of it.", () => tell("start"))
  start.className = "start"
  const cancel = button("Cancel", "End it; what has come stays.", () => tell("cancel"))
  const mesh = button("Is the mesh fine enough?", "Take the quantity on three meshes, and " +
    "with three numbers of instants: half as fine, as it is, and twice as fine.", () => tell("mesh"))
  const rest = make("span"), meshes = make("div", {className: "meshes", ariaLive: "polite"})
  const asked = make("div", {className: "row"}, make("b", {}, "Show"), quantity, words, at, start,
    cancel, mesh, rest, refused)
  const bar = make("progress", {ariaLabel: "Share of the runs"}), far = make("span")
  const seen = () => Bokeh.index.find_one_by_id(model.chart.id)
  const picture = () => pictured(seen(), model.chart.legend, "")
  const exports = make("span", {className: "end"})
  exports.append(
    button("Table (CSV)", "Save the table of all runs.", () => tell("table")), " ",
    button("Chart (SVG)", "Save the chart.", () => save_svg(NAME, picture())), " ",
    button("Chart (PNG)", "Save the chart, painted.", () => save_png(NAME, picture())))
  const choose = () => tell("columns", {x: across.value, y: up.value})
  const [up, across] = ["Drawn up", "Drawn across"].map((ariaLabel) =>
    make("select", {ariaLabel, onchange: choose}))
  const drawn_columns = make("span", {className: "columns"}, "Plot ", up, " over ", across)
  const progress = make("div", {className: "row"}, bar, far, drawn_columns, exports)
  const legend = make("div", {className: "legend title"})
  const ended = make("span", {role: "status", className: "unseen"})
  const root = make("div", {className: "all"}, ready, ...spans.map(({row}) => row), asked, meshes, progress,
    legend, ended)
  const follow_columns = () => {
    const {names = [], x, y} = model.columns
    drawn_columns.hidden = !names.length
    filled(up, names, y ?? "")
    filled(across, names, x ?? "")
  }
  let wasBusy = false
  const follow_chart = () => {
    const {id, legend: keys, label} = model.chart
    legend.hidden = !id
    legend.innerHTML = keys ? `${keys}<span>A click opens the run.</span>` : ""
    if (id) { walk(seen, label, () => tell("there", id), (number) => tell("run", number)) }
  }
  const show = () => {
    const {form} = model
    ready.hidden = !form.ready.length
    const names = JSON.stringify(form.ready)
    if (ready.names !== names) {
      ready.names = names
      ready.replaceChildren(make("b", {}, "Ready"),
        ...form.ready.map(([title, help]) => button(title, help, () => tell("ready", title))))
    }
    for (const one of spans) { one.show(form) }
    filled(quantity, form.quantities.map(({name, title}) => [name, title]), form.quantity)
    const own = form.quantities.find(({name}) => name === form.quantity)
    const [before, after] = (own?.at ?? "").split("{:g}")
    at.hidden = !own?.at
    words.textContent = [before, after].filter((one) => one?.trim()).join(" … ").trim()
    put(at, form.at)
    refused.textContent = form.refusals.of ?? form.refusals.all ?? ""
    start.disabled = Object.keys(form.refusals).length > 0
    rest.textContent = `All else is as in the controls: ${form.rest}.`
  }
  const follow = () => {
    const {busy, share, words, moved} = model.progress
    cancel.hidden = bar.hidden = !busy
    bar.value = share ?? 0
    progress.hidden = !words
    const note = moved ? " The controls have changed since; Start asks again." : ""
    far.textContent = `${words ?? ""}${note}`
    if (wasBusy && !busy) { ended.textContent = words }
    wasBusy = busy
  }
  const follow_meshes = () => {
    const {can, busy, words, found} = model.mesh
    mesh.disabled = !can && !busy
    mesh.textContent = busy ? "Cancel the meshes" : "Is the mesh fine enough?"
    meshes.innerHTML = found ?? ""
    meshes.append(words ? ` ${words}` : "")
    meshes.hidden = !found && !words
  }
  model.on("form", show)
  model.on("mesh", follow_meshes)
  model.on("progress", follow)
  model.on("chart", follow_chart)
  model.on("columns", follow_columns)
  model.on("file", () => save(model.file[1], new Blob([model.file[0]], {type: "text/csv"})))
  show()
  follow()
  follow_meshes()
  follow_chart()
  follow_columns()
  return root
}
