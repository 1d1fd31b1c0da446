// Controls of settings, for the components that hold some.
function controls(model) {
  const tell = (row, value, hand = false) => {
    // The time numbers the messages of all components of a page in one order.
    const count = row.count = performance.now()
    model.send_msg({name: row.name, value, hand, count})
  }
  const named = (item, input) => {
    input.ariaLabel = say(item.label)
    return input
  }
  const slider = (row, item) => {
    const step = item.whole && !item.log ? 1 : "any"
    const range = named(item, make("input", {type: "range", step}))
    // One stop of the Tab key for both: Enter, or a digit, goes from the slider to its number.
    const field = named(item,
      make("input", {className: "number", inputMode: "decimal", tabIndex: -1}))
    const label = make("label", {className: "typed"}, make("span", {}, say(item.label)), field)
    let {start, end} = item
    const place = (value) => item.log ? Math.log10(value) : value
    const read = () => Math.min(Math.max(settled(item, range.valueAsNumber), start), end)
    const put = (value) => {
      range.ariaValueText = written(value, item)
      range.ariaValueNow = value
      if (!field.typed) { field.value = written(value, item) }
    }
    const reset = () => tell(row, item.usual)
    let last
    range.oninput = () => {
      if (read() === last) { return }
      put(last = read())
      tell(row, last, true)
    }
    range.onchange = () => tell(row, null)
    range.onkeydown = (event) => {
      const {key} = event, types = !event.ctrlKey && !event.metaKey && /^[-.\d]$/.test(key)
      if (["Delete", "Backspace"].includes(key)) { reset() }
      else if (types) { field.focus() }
      else if (key === "Enter") {
        event.preventDefault()
        field.focus()
      }
    }
    field.onkeydown = ({key}) => { if (key === "Enter") { range.focus() } }
    range.ondblclick = label.firstElementChild.ondblclick = reset
    field.onfocus = () => field.select()
    field.oninput = () => { field.typed = true }
    field.onchange = () => {
      const text = field.value.trim().replace(",", "."), value = Number(text)
      field.typed = false
      // What is no number is refused as any other value, in the same words.
      tell(row, text && Number.isFinite(value) ? value : text)
    }
    row.show = (value, most = item.end) => {
      start = Math.min(item.start, value)
      end = Math.max(Math.min(item.end, most), value)
      range.min = place(start)
      range.max = place(end)
      // Between two whole numbers a logarithmic slider would never leave the lower one.
      if (read() !== value || last === undefined) { range.value = place(value) }
      put(last = value)
    }
    return [label, range]
  }
  const choice = (row, item) => {
    const select = named(item, make("select", {onchange: () => tell(row, select.value)}))
    for (const [text, value, group] of item.options) {
      const heard = [...select.children].find(({named: of}) => group && of === group)
      const place = heard ?? (group ? make("optgroup", {label: say(group), named: group}) : select)
      if (place !== select) { select.append(place) }
      place.append(new Option(say(text), value))
    }
    row.show = (value) => { select.value = value }
    return [make("label", {}, say(item.label)), select]
  }
  const flip = (row, item) => {
    const box = make("input", {type: "checkbox", onchange: () => tell(row, box.checked)})
    box.setAttribute("role", "switch")
    row.show = (value) => { box.checked = value }
    return [make("label", {}, box, " " + say(item.label))]
  }
  const curve = (row, item) => {
    const parts = choice(row, item), show = row.show
    const body = make("tbody"), head = make("tr")
    head.append(...[...item.columns, "", ""].map((one) => make("td", {}, say(one))))
    const table = make("table", {}, make("thead", {}, head), body)
    const read = () => [...body.rows].map((one) =>
      [...one.querySelectorAll("input")].map((input) => input.valueAsNumber))
    const send = (rows) => {
      if (rows.every((one) => one.every(Number.isFinite))) { tell(row, rows) }
    }
    const path = drawn_points(item, send)
    const told = make("p"), listed = make("div", {className: "points"}, table)
    const points = make("div", {}, path.picture, listed, told)
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
      button("+", say("Add a row below"), () => added(place)),
      button("−", say("Take this row away"), () => taken(place)),
    ].map((one) => make("td", {}, one)))
    row.show = (value) => {
      const long = value.count, own = Array.isArray(value) ? value : []
      show(own.length || long ? item.options.at(-1)[1] : value)
      points.hidden = !own.length && !long
      listed.hidden = Boolean(long)
      told.textContent = long ? say("{} points. Change them in their file.", long) : ""
      path.show(long ? value.drawn : own, Boolean(long))
      if (JSON.stringify(read()) !== JSON.stringify(own)) {
        body.replaceChildren(...own.map(line))
      }
    }
    return [...parts, points]
  }
  // A control that was moved since says what it was moved to.
  const show = (rows) => {
    const {"": obeyed, "the-ends": ends} = model.shown
    for (const [name, row] of rows) {
      row.box.hidden = !(name in model.shown)
      if (!row.box.hidden && row.count <= obeyed) { row.show(model.shown[name], ends?.[name]) }
    }
  }
  return {tell, named, show, kinds: {slider, choice, flip, curve}}
}
