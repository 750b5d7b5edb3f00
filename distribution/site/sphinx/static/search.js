// The search of the theme finds a keyword only by a part of it, and puts it below whatever contains the words.
// Here the pages come first of which a keyword is the search, or the longest keyword in it: "how do I set a sample time".
// What is equally good is in the order of these folders, not in that of the alphabet.
const FOLDERS = ["learn", "guides", "gallery", "reference/language", "reference", "explanations"];
const PER_KEYWORD = 100;

const words = (text) => ` ${text.toLowerCase().replace(/[?!.,"']/g, " ").trim().replace(/\s+/g, " ")} `;

function pagesOfKeyword(query) {
  const { docnames, filenames, indexentries, titles } = Search._index;
  const asked = words(query);
  const known = Object.entries(indexentries).map(([word, places]) => [word, places.filter(([, anchor]) => anchor === "")]);
  const found = known.filter(([word, places]) => places.length > 0 && asked.includes(words(word)));
  const longest = Math.max(...found.map(([word]) => word.length));
  return found
    .filter(([word]) => word.length === longest)
    .flatMap(([, places]) => places.map(([file]) => [docnames[file], titles[file], "", null, PER_KEYWORD, filenames[file], "index"]))
    .sort(([one], [other]) => rank(one) - rank(other));
}

function rank(place) {
  const found = FOLDERS.findIndex((folder) => place.startsWith(folder));
  return found < 0 ? FOLDERS.length : found;
}

document.addEventListener("DOMContentLoaded", () => {
  if (typeof Search === "undefined") return;
  const perform = Search._performSearch;
  Scorer.score = ([place, , , , score]) => score - rank(place) / (FOLDERS.length + 1);
  Search._performSearch = (query, ...terms) => {
    const first = pagesOfKeyword(query);
    const places = new Set(first.map(([place]) => place));
    const others = perform(query, ...terms).filter(([place, , anchor]) => anchor !== "" || !places.has(place));
    return [...others, ...first.reverse()]; // Shown from the end.
  };
});
