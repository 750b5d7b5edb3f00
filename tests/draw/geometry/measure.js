// Measures the drawings on this page as the browser shows them: which words overlap, and which lines run through words.
function measured(svg) {
  const faults = [];
  const shown = (text) => text.textContent;
  const inked = (text) => {
    // A fifth of the line is free above capitals, and a fifth below the baseline.
    const r = text.getBoundingClientRect();
    return { left: r.left + 0.3, right: r.right - 0.3, top: r.top + 0.22 * r.height, bottom: r.bottom - 0.22 * r.height };
  };
  const texts = [...svg.querySelectorAll("text")].map((text) => ({ text, place: inked(text) }));
  const overlap = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
  texts.forEach((first, index) => {
    for (const second of texts.slice(index + 1)) {
      if (overlap(first.place, second.place)) faults.push(`${shown(first.text)} lies on ${shown(second.text)}`);
    }
  });
  const shapes = [...svg.querySelectorAll("rect, ellipse, path")].filter((shape) => shape.parentNode !== svg);
  const boxes = [...svg.querySelectorAll("rect")].map((box) => ({ box, place: box.getBoundingClientRect() }));
  const covers = ({ box, place }, words) =>
    box.getAttribute("fill") !== "none" && place.left <= words.left && words.right <= place.right && place.top <= words.top && words.bottom <= place.bottom;
  const before = (a, b) => Boolean(a.compareDocumentPosition(b) & Node.DOCUMENT_POSITION_FOLLOWING);
  for (const shape of shapes) {
    if (!shape.hasAttribute("stroke")) continue;
    const bounds = shape.getBoundingClientRect();
    const surrounds = (words) => shape.localName === "rect" && bounds.left < words.left && words.right < bounds.right && bounds.top < words.top && words.bottom < bounds.bottom;
    const near = texts.filter(({ place }) => overlap(place, { left: bounds.left - 1, right: bounds.right + 1, top: bounds.top - 1, bottom: bounds.bottom + 1 }) && !surrounds(place));
    if (near.length === 0) continue;
    const toScreen = shape.getScreenCTM();
    const length = shape.getTotalLength();
    for (const { text, place } of near) {
      if (boxes.some((each) => before(shape, each.box) && before(each.box, text) && covers(each, place))) continue;
      for (let at = 0; at <= length; at += 3) {
        const point = shape.getPointAtLength(at).matrixTransform(toScreen);
        if (place.left < point.x && point.x < place.right && place.top < point.y && point.y < place.bottom) {
          faults.push(`a line runs through ${shown(text)}`);
          break;
        }
      }
    }
  }
  const sheet = svg.getBoundingClientRect();
  for (const { text, place } of texts) {
    if (place.left < sheet.left || place.right > sheet.right || place.top < sheet.top || place.bottom > sheet.bottom) faults.push(`${shown(text)} leaves the sheet`);
  }
  return { words: texts.length, shapes: shapes.length, width: sheet.width, faults };
}
const results = {};
for (const figure of document.querySelectorAll("figure")) results[figure.id] = measured(figure.querySelector("svg"));
const answer = document.createElement("pre");
answer.id = "answer";
answer.textContent = JSON.stringify(results);
document.body.append(answer);
