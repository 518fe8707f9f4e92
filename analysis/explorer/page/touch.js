// Fingers on planes and sliders: a vertical movement scrolls the page, a horizontal one and a tap are for the control.

/** How far a finger moves, pixels, before its direction counts. */
const slack = 8;

/** Whether a pointer has moved horizontally since `start`, an event or {clientX, clientY}. */
export function hasSlid(start, { clientX, clientY }) {
  const across = Math.abs(clientX - start.clientX);
  return across > slack && across > Math.abs(clientY - start.clientY);
}

/** Reports the input of a slider; of a finger only when it slides or taps, and not when it scrolls the page. */
export function onSlide(slider, report) {
  let touch = null; // a touch that may yet scroll the page
  const decide = () => {
    const hasChanged = slider.value !== touch.value;
    touch = null;
    if (hasChanged) report();
  };
  slider.oninput = () => {
    if (!touch) report();
  };
  slider.onpointerdown = ({ pointerType, clientX, clientY }) => {
    if (pointerType === "touch") touch = { value: slider.value, clientX, clientY };
  };
  slider.onpointermove = (event) => touch && hasSlid(touch, event) && decide();
  slider.onpointerup = () => touch && decide();
  slider.onpointercancel = () => {
    if (touch) slider.value = touch.value;
    touch = null;
  };
}
