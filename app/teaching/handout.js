// A lesson on paper: the question in front, with room to write, and overleaf the answer.
const ON_PAPER = `
  @page { size: A4; margin: 16mm; }
  body { max-width: 178mm; margin: 0 auto; font: 11pt/1.45 system-ui, sans-serif; color: #000; }
  h1 { font-size: 18pt; margin: 0; } h2 { font-size: 14pt; }
  .picture > svg { width: 100%; max-height: 75mm; }
  .picture > .pad { display: block; max-width: 100mm; margin: 0 auto; }
  .dark .picture > svg:not(.pad) { filter: invert(1) hue-rotate(180deg); }
  .question { font-weight: 600; } ul { list-style: "☐  "; padding-left: 2em; }
  .room { height: 70mm; background: repeating-linear-gradient(#fff 0 9mm, #bbb 9mm 9.4mm); }
  .overleaf { break-before: page; }
  .plots { display: grid; grid-template-columns: 1fr 1fr; gap: 4mm; }
  small { color: #444; }`
const handout = (lesson, texts, address) => {
  const part = ([kind, text]) => {
    const control = () => say(lesson.items.find((one) => one.name === text).label)
    if (kind === "control") { return make("b", {}, control()) }
    if (kind === "value") { return make("b", {innerHTML: texts.get(text) ?? "…"}) }
    return kind === "text" ? text : make(kind, {}, text)
  }
  const paragraphs = (all) => all.map((parts) => make("p", {}, ...parts.map(part)))
  const picture = (slug) => {
    const {width, height, text} = plot_of(slug, "")
    const box = make("div", {className: "picture", innerHTML: text}), plot = box.firstChild
    plot.setAttribute("viewBox", `0 0 ${width} ${height}`)
    plot.firstChild.setAttribute("fill", "none")
    return box
  }
  const empty = () => sketchpad({...lesson.curve, values: []}, blank(), () => {})
  const full = () => make("div", {className: "picture"}, sketchpad(lesson.curve, blank(), () => {}))
  const [thing, ...others] = lesson.slugs.filter(is_drawn)
  const front = [
    make("small", {}, `Slipfront, ${lesson.place}`), make("h1", {}, lesson.title),
    ...paragraphs(lesson.text), ...(thing ? [picture(thing)] : []),
    make("p", {className: "question"}, lesson.question),
    make("ul", {}, ...lesson.choices.map((choice) => make("li", {}, choice))),
    ...(lesson.curve ? [make("div", {className: "picture"}, empty())] : []),
    make("p", {}, say("Why?")), make("div", {className: "room"}),
  ]
  const back = make("section", {className: "overleaf"},
    make("h2", {}, `${lesson.choices[lesson.right]}.`), make("p", {}, lesson.why),
    ...paragraphs(lesson.explanation),
    make("div", {className: "plots"},
      ...(lesson.curve ? [full()] : []), ...others.map(picture)),
    make("p", {}, make("small", {}, say("To try it: {}", address))))
  const theme = document.documentElement.dataset.theme ?? ""
  const body = make("body", {className: theme}, ...front, back)
  const head = `<meta charset="utf-8"><title>${lesson.title}</title><style>${ON_PAPER}</style>`
  return `<!doctype html><html lang="${document.documentElement.lang}"><head>${head}</head>${body.outerHTML}</html>`
}
