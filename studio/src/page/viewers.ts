/** Several pages may show one program; one of them controls it. */

import { type Engine, inWords } from "../engine/engine";
import type { HandState } from "../engine/messages";
import { button, element } from "./dom";

export function viewers(engine: Engine, report: (text: string) => void, changed: (controls: boolean) => void): (state: HandState) => void {
  const note = element("hand-note", HTMLElement);
  const take = () => {
    engine.request("take_hand", {}).catch((problem: unknown) => report(inWords(problem)));
  };
  const show = ({ hand, page, held_by, viewers }: HandState) => {
    note.hidden = hand && viewers < 2;
    const watches = viewers === 2 ? "another one watches" : `${viewers - 1} others watch`;
    const holder = held_by === null ? "Another page" : `Page ${held_by}`;
    note.replaceChildren(
      ...(hand ? [`This is page ${page}. It controls the program; ${watches}.`] : [`${holder} controls the program; this is page ${page}, and watches. `, button("Take control", take)]),
    );
    changed(hand);
  };
  engine.on("hand", show);
  return show;
}
