export function render({model}) {
  const {make, tell, kinds} = controls(model)
  const LESSON = "the-lesson", CHOICE = "the-choice", SEEN = "slipfront-lessons-seen"
  const root = make("section", {ariaLabel: "Lesson"})
  let rows = new Map(), places = []
  // A browser may refuse to keep anything.
  const seen = () => { try { return localStorage.getItem(SEEN) } catch { return null } }
  const see = () => { try { localStorage.setItem(SEEN, "yes") } catch {} }
  const button = (text, onclick, more = {}) =>
    make("button", {type: "button", onclick, ...more}, text)
  const open = (name) => {
    see()
    tell({name: LESSON}, name)
  }
  const control = (name) => {
    const item = model.lesson.items.find((one) => one.name === name), row = {name, count: 0}
    row.box = make("span", {className: `control setting-${name}`, title: item.help || ""},
      ...kinds[item.kind](row, item))
    rows.set(name, row)
    return row.box
  }
  const part = ([kind, text, title]) => {
    if (kind === "control") { return control(text) }
    if (kind !== "value") { return kind === "text" ? text : make(kind, {}, text) }
    const place = make("span", {className: "value", title}, "…")
    places.push([text, place])
    return place
  }
  const paragraphs = (all) => all.map((parts) => make("p", {}, ...parts.map(part)))
  const choices = (all) => {
    const made = all.map((text, place) => button(text, () => tell({name: CHOICE}, place)))
    const group = make("div", {className: "choices", ariaLabel: "Your prediction"}, ...made)
    group.setAttribute("role", "group")
    return group
  }
  const verdict = ({choices, choice, right, why}) => {
    const is = choice < 0 ? "skipped" : choice === right ? "right" : "wrong"
    const word = {skipped: "", right: "Right: ", wrong: `Not “${choices[choice]}”, but: `}[is]
    const answer = make("b", {}, `${word}${choices[right]}.`)
    return make("p", {className: `why ${is}`, tabIndex: -1}, answer, " ", why)
  }
  const skip = () => button("Show me", () => tell({name: CHOICE}, -1),
    {title: "See it without a prediction."})
  const go_on = ([name, title]) =>
    name ? [button(`Next: ${title}`, () => open(name), {className: "main"})] : []
  const leave = () => button("Explore freely", () => open(""),
    {title: "Leave the lesson: all controls, and the run as it is."})
  const taught = (lesson) => {
    const heads = [make("small", {}, lesson.place), make("h2", {}, lesson.title)]
    const text = paragraphs(lesson.text)
    const question = make("p", {className: "question"}, lesson.question)
    if (lesson.choice === undefined) {
      return [...heads, ...text, question, choices(lesson.choices), skip(), leave()]
    }
    const before = make("details", {}, make("summary", {}, "What it is about"), ...text)
    return [...heads, before, question, verdict(lesson), ...paragraphs(lesson.explanation),
      ...go_on(lesson.next), leave()]
  }
  const offer = () => {
    const list = model.offered.map(([name, title, question]) =>
      make("li", {}, button(title, () => open(name)), make("span", {}, question)))
    const words = `New here? ${list.length} short lessons: predict, change one thing, see why.`
    const away = () => {
      see()
      build()
    }
    return make("div", {className: "offer"},
      make("details", {}, make("summary", {}, words), make("ol", {}, ...list)),
      button("×", away, {ariaLabel: "Hide the lessons", title: "Hide; the sidebar has them."}))
  }
  const build = () => {
    const {lesson} = model, was_asked = root.querySelector(".choices") !== null
    rows = new Map()
    places = []
    const now = lesson.title ? [make("article", {}, ...taught(lesson))] : seen() ? [] : [offer()]
    root.replaceChildren(...now)
    show()
    fill()
    if (was_asked && lesson.choice !== undefined) { root.querySelector(".why").focus() }
  }
  const show = () => {
    const obeyed = model.shown[""]
    for (const [name, row] of rows) {
      row.box.hidden = !(name in model.shown)
      if (!row.box.hidden && row.count <= obeyed) { row.show(model.shown[name]) }
    }
  }
  const fill = () => {
    const texts = new Map(model.values)
    for (const [name, place] of places) { place.innerHTML = texts.get(name) ?? "…" }
  }
  model.on("lesson", build)
  model.on("shown", show)
  model.on("values", fill)
  build()
  return root
}
