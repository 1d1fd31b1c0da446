const PRINTED =
  "Save a page to print: the question, with room to write, and the answer overleaf."
export function render({model}) {
  const {tell, show: put, kinds} = controls(model)
  const LESSON = "the-lesson", CHOICE = "the-choice", COUNT = "the-count"
  const SEEN = "slipfront-lessons-seen"
  const root = make("section", {ariaLabel: say("Lesson")})
  let rows = new Map(), places = [], taught_last = "", step = 0, turn = () => {}
  // A browser may refuse to keep anything.
  const seen = () => { try { return localStorage.getItem(SEEN) } catch { return null } }
  const see = () => { try { localStorage.setItem(SEEN, "yes") } catch {} }
  // A page that is loaded again knows what was predicted on it.
  const PREDICTED = "slipfront-predicted"
  const predicted = () => {
    try { return JSON.parse(sessionStorage.getItem(PREDICTED)) ?? [] } catch { return [] }
  }
  const predict = (place) => {
    try { sessionStorage.setItem(PREDICTED, JSON.stringify([model.lesson.title, place])) } catch {}
    tell({name: CHOICE}, place)
  }
  // What was drawn by hand goes on being there as long as what was predicted.
  const SKETCH = "slipfront-sketch"
  let drawing = ["", blank()]
  const sketched = () => {
    const {title} = model.lesson, stored = () => JSON.parse(sessionStorage.getItem(SKETCH)) ?? [""]
    if (drawing[0] !== title) {
      drawing = [title, blank()]
      try { if (stored()[0] === title) { drawing = stored() } } catch {}
    }
    return drawing[1]
  }
  const keep = () => {
    try { sessionStorage.setItem(SKETCH, JSON.stringify(drawing)) } catch {}
  }
  const curve = ({curve: axes}) => {
    if (!axes) { return [] }
    const sketch = sketched(), by_hand = sketch.some((one) => one !== null)
    const pad = sketchpad(axes, sketch, keep)
    if (!axes.values.length) {
      const words = say("Draw what you expect, with the mouse or a finger.")
      return [make("figure", {}, pad, make("figcaption", {}, words))]
    }
    const words = say(by_hand ? "Your curve, and what was measured" : "What was measured")
    return [make("details", {open: by_hand}, make("summary", {}, words), make("figure", {}, pad))]
  }
  const button = (text, onclick, more = {}) =>
    make("button", {type: "button", onclick, ...more}, text)
  const open = (name) => {
    see()
    tell({name: LESSON}, name)
  }
  const control = (name) => {
    const item = model.lesson.items.find((one) => one.name === name), row = {name, count: 0}
    row.box = make("span", {className: `control setting-${name}`, title: say(item.help || "")},
      ...kinds[item.kind](row, item))
    rows.set(name, row)
    return row.box
  }
  const part = ([kind, text, title]) => {
    if (kind === "control") { return control(text) }
    if (kind !== "value") { return kind === "text" ? text : make(kind, {}, text) }
    const place = make("span", {className: "value", title: say(title)}, "…")
    places.push([text, place])
    return place
  }
  const paragraphs = (all) => all.map((parts) => make("p", {}, ...parts.map(part)))
  // Of a class: how many predicted what, on the choices themselves.
  const share = (place) => {
    const {counts, predicted} = model.poll, count = counts?.[place]
    return count === undefined ? [] : [` — ${count}`, `${100 * count / Math.max(predicted, 1)}%`]
  }
  const counted = (made, place) => {
    const [text, width] = share(place)
    if (text) { made.append(make("span", {className: "votes"}, text)) }
    made.style.setProperty("--share", width ?? "0%")
    return made
  }
  const choices = ({choices: all, chosen}) => {
    const made = all.map((text, place) => {
      const one = button(text, () => predict(place))
      one.ariaPressed = chosen === place
      return counted(one, place)
    })
    const group = make("div", {className: "choices", ariaLabel: say("Your prediction")}, ...made)
    group.setAttribute("role", "group")
    return group
  }
  const verdict = ({choices, choice, right, why}) => {
    const is = choice < 0 ? "skipped" : choice === right ? "right" : "wrong"
    const words = {skipped: "{1}.", right: "Right: {1}.", wrong: "Not “{0}”, but: {1}."}[is]
    const answer = make("b", {}, say(words, choices[choice], choices[right]))
    return make("p", {className: `why ${is}`, tabIndex: -1}, answer, " ", why)
  }
  const counts = ({choices: all, right}) => model.poll.counts?.length
    ? [make("ul", {className: "counts", ariaLabel: say("What the class predicted")},
      ...all.map((text, place) => {
        const is_right = place === right
        const said = is_right ? [make("b", {ariaLabel: say("Right:")}, "✓ "), text] : [text]
        return counted(make("li", {className: is_right ? "right" : ""}, ...said), place)
      }))] : []
  const polled = ({chosen}) => {
    const {leads, predicted, of, counts} = model.poll
    if (predicted === undefined) { return [] }
    const said = say("{} of {} have predicted.", predicted, of)
    const mine = leads ? "" : model.lesson.alone ? "Nobody leads the class at present."
      : chosen === null ? "Predict, too: the answer comes with the class."
      : "The answer comes with the class."
    const open = leads && !counts.length
      ? [button(say("Show what they predict"), () => tell({name: COUNT}, true))] : []
    return [make("p", {className: "polled"}, said, " ", say(mine)), ...open]
  }
  const skip = () => button(say("Show me"), () => predict(-1),
    {title: say("See it without a prediction.")})
  const go_on = ([name, title]) =>
    name ? [button(say("Next: {}", title), () => open(name), {className: "main"})] : []
  const leave = () => button(say("Explore freely"), () => open(""),
    {title: say("Leave the lesson: all controls, and the run as it is.")})
  const on_paper = () => button(say("Handout"), () => {
    const address = `${location.origin}${location.pathname}?lesson=${model.lesson.name}`
    const page = handout(model.lesson, new Map(model.values), address)
    save(`slipfront-${model.lesson.name}.html`, new Blob([page], {type: "text/html"}))
  }, {title: say(PRINTED)})
  // In front of a class one thing is said at a time, in a type for the back row.
  const is_strip = () => model.is_strip && matchMedia("(min-width: 1001px)").matches
  const folded = (text) => make("details", {}, make("summary", {}, say("What it is about")), ...text)
  const taught = (lesson) => {
    const heads = [make("small", {}, lesson.place), make("h2", {}, lesson.title)]
    const text = paragraphs(lesson.text)
    const question = make("p", {className: "question"}, lesson.question)
    if (lesson.choice === undefined) {
      const ends = !lesson.follows ? [skip(), leave()] : lesson.alone ? [skip()] : []
      const ask = make("div", {className: "ask"}, ...curve(lesson), choices(lesson))
      const asked = [question, ask, ...polled(lesson), ...ends]
      return is_strip() ? [...heads, ...asked, folded(text)] : [...heads, ...text, ...asked]
    }
    const ends = lesson.follows ? [] : [...go_on(lesson.next), on_paper(), leave()]
    const told = paragraphs(lesson.explanation), votes = counts(lesson), answer = verdict(lesson)
    if (!is_strip()) {
      const answered = [question, ...votes, answer, ...curve(lesson)]
      return [...heads, folded(text), ...answered, ...told, ...ends]
    }
    const own = sketched().some((one) => one !== null) ? [curve(lesson)] : []
    const said = votes.length ? [[question, ...votes], [answer]] : [[question, answer]]
    const first = [...said, ...own]
    const last = ends.length ? [make("p", {}, ...ends)] : []
    return strip([...first, ...told.map((one) => [one]), ...last.map((one) => [one])])
  }
  const strip = (parts) => {
    const boxes = parts.map((part) => make("div", {}, ...part)), end = boxes.length - 1
    const back = button("‹", () => turn(-1), {ariaLabel: say("Back"), title: say("Back (Page ↑).")})
    const on = button("›", () => turn(1), {ariaLabel: say("Go on"), title: say("Go on (Page ↓).")})
    const place = make("span")
    turn = (by) => {
      step = Math.min(Math.max(step + by, 0), end)
      boxes.forEach((box, number) => { box.hidden = number !== step })
      back.disabled = step === 0
      on.disabled = step === end
      place.textContent = say("{} of {}", step + 1, boxes.length)
    }
    turn(0)
    return [...boxes, make("nav", {ariaLabel: say("Parts of the lesson")}, back, place, on)]
  }
  const offer = () => {
    const lists = new Map()
    model.offered.forEach(([name, title, question, subject], place) => {
      if (!lists.has(subject)) { lists.set(subject, make("ol", {start: place + 1})) }
      lists.get(subject).append(
        make("li", {}, button(title, () => open(name)), make("span", {}, question)))
    })
    const counts = [...lists].map(([subject, list]) => say("{} in {}", list.children.length, say(subject)))
    const words = say("New here? Short lessons, {}: predict, change one thing, see why.",
      counts.join(` ${say("and")} `))
    const parts = [...lists].flatMap(([subject, list]) => [make("h4", {}, say(subject)), list])
    const away = () => {
      see()
      build()
    }
    return make("div", {className: "offer"},
      make("details", {}, make("summary", {}, words), ...parts),
      button("×", away, {ariaLabel: say("Hide the lessons"),
        title: say("Hide; the sidebar has them.")}))
  }
  const build = () => {
    const {lesson} = model, was_asked = root.querySelector(".choices") !== null
    rows = new Map()
    places = []
    turn = () => {}
    if (lesson.title !== taught_last || lesson.choice === undefined) { step = 0 }
    taught_last = lesson.title
    const className = is_strip() ? "strip" : ""
    const now = lesson.title
      ? [make("article", {className}, ...taught(lesson))] : seen() ? [] : [offer()]
    root.replaceChildren(...now)
    show()
    fill()
    if (was_asked && lesson.choice !== undefined) { root.querySelector(".why").focus() }
  }
  const show = () => put(rows)
  const fill = () => {
    const texts = new Map(model.values)
    for (const [name, place] of places) { place.innerHTML = texts.get(name) ?? "…" }
  }
  // After the question comes what a class predicts, and then the answer.
  const go_to_answer = () => {
    const {follows, alone} = model.lesson, {leads, counts} = model.poll
    if (leads && !counts.length) { tell({name: COUNT}, true) }
    else if (!follows || leads || alone) { predict(-1) }
  }
  // These are what a presenter's remote control sends.
  const press = (event) => {
    const by = {PageDown: 1, PageUp: -1}[event.key], asks = root.querySelector(".strip .choices")
    if (!by || !asks && !root.querySelector(".strip nav")) { return }
    event.preventDefault()
    if (!asks) { turn(by) }
    else if (by === 1) { go_to_answer() }
  }
  document.addEventListener("keydown", press)
  model.on("remove", () => document.removeEventListener("keydown", press))
  model.on("lesson", build)
  model.on("is_strip", build)
  model.on("poll", build)
  model.on("shown", show)
  model.on("values", fill)
  // Before the whole page is built, nothing that one tells arrives.
  model.on("recalls", () => {
    const [title, place] = predicted()
    if (title && title === model.lesson.title) { tell({name: CHOICE}, place) }
  })
  build()
  return root
}
