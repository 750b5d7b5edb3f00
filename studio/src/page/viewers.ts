/** Several pages may show one program; one of them controls it. */

import { type Engine, inWords } from "../engine/engine";
import type { HandState } from "../engine/messages";
import { button, element } from "./dom";

export function viewers(engine: Engine, report: (text: string) => void, changed: (controls: boolean) => void): (state: HandState) => void {
  const note = element("hand-note", HTMLElement);
  const take = () => {
    engine.request("take_hand", {}).catch((problem: unknown) => report(inWords(problem)));
  };
  const show = ({ hand }: HandState) => {
    note.hidden = hand;
    note.replaceChildren(...(hand ? [] : ["Another page controls the program. ", button("Take control", take)]));
    changed(hand);
  };
  engine.on("hand", show);
  return show;
}
