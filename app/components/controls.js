// Controls of settings, for the components that hold some.
const KEPT = "path=/; max-age=31536000; SameSite=Lax"
function controls(model) {
  const tell = (row, value, hand = false) => {
    // The time numbers the messages of all components of a page in one order.
    const count = row.count = performance.now()
    model.send_msg({name: row.name, value, hand, count})
  }
  const called = (item, input) => {
    input.ariaLabel = say(item.label)
    return input
  }
  const steps = (unit) => LADDERS[unit]?.[model.shown["the-units"]] ?? [[unit, 1, 0]]
  const names = (unit) => Object.values(LADDERS[unit] ?? {}).flat()
  const slider = (row, item) => {
    const step = item.whole && !item.log ? 1 : "any"
    const range = called(item, make("input", {type: "range", step}))
    // One stop of the Tab key for both: Enter, or a digit, goes from the slider to its number.
    const field = make("input", {className: "number", inputMode: "decimal", tabIndex: -1})
    const words = make("span"), label = make("label", {className: "typed"}, words, field)
    let {start, end} = item, factor = 1
    const place = (value) => item.log ? Math.log10(value) : value
    const read = () => Math.min(Math.max(settled(item, range.valueAsNumber), start), end)
    const put = (value) => {
      const [unit, size] = step_of(value || item.end, steps(item.unit))
      const text = written(scaled(value, size), item)
      range.ariaValueText = `${text} ${unit}`.trim()
      range.ariaValueNow = value
      if (field.typed) { return }
      factor = size
      field.value = text
      words.textContent = field.ariaLabel = labelled(say(item.label), unit)
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
    range.ondblclick = words.ondblclick = reset
    field.onfocus = () => field.select()
    field.oninput = () => { field.typed = true }
    field.onchange = () => {
      field.typed = false
      tell(row, typed_value(field.value, names(item.unit), factor))
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
    const select = called(item, make("select", {onchange: () => {
      if (item.cookie) { document.cookie = `${item.cookie}=${select.value}; ${KEPT}` }
      tell(row, select.value)
    }}))
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
    let factors = [1, 1]
    const table = make("table", {}, make("thead", {}, head), body)
    const read = () => [...body.rows].map((one) =>
      [...one.querySelectorAll("input")].map((input, i) => in_si(input.valueAsNumber, factors[i])))
    const send = (rows) => {
      if (rows.every((one) => one.every(Number.isFinite))) { tell(row, rows) }
    }
    const path = drawn_points(send)
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
      ...pair.map((value, i) => number(scaled(value, factors[i]))),
      button("+", say("Add a row below"), () => added(place)),
      button("−", say("Take this row away"), () => taken(place)),
    ].map((one) => make("td", {}, one)))
    // Columns are in the units of their largest values.
    const measure = (points) => {
      const found = item.columns.map(([, unit], i) =>
        step_of(Math.max(0, ...points.map((one) => Math.abs(one[i]))), steps(unit)))
      const titles = item.columns.map(([title], i) => labelled(say(title), found[i][0]))
      head.replaceChildren(...[...titles, "", ""].map((one) => make("td", {}, one)))
      const is_new = found.some(([, factor], i) => factor !== factors[i])
      factors = found.map(([, factor]) => factor)
      path.tell((pair) =>
        pair.map((value, i) => `${titles[i]}: ${scaled(value, factors[i])}`).join(", "))
      return is_new
    }
    row.show = (value) => {
      const long = value.count, own = Array.isArray(value) ? value : []
      show(own.length || long ? item.options.at(-1)[1] : value)
      points.hidden = !own.length && !long
      listed.hidden = Boolean(long)
      told.textContent = long ? say("{} points. Change them in their file.", long) : ""
      const is_new = measure(long ? value.drawn : own)
      path.show(long ? value.drawn : own, Boolean(long))
      if (is_new || JSON.stringify(read()) !== JSON.stringify(own)) {
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
  return {tell, called, show, kinds: {slider, choice, flip, curve}}
}
