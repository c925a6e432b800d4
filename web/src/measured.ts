/** How many times as large as usual letters are: on a very large screen they grow, and so
 * must what is drawn beside them. */
export const letters = (): number =>
  (parseFloat(getComputedStyle(document.documentElement).fontSize) || 16) / 16;

/**
 * How large an element is shown: told by the browser when it has laid the page out. To read
 * an element's width instead has it lay out there and then, once for each that asks.
 */
export function measured(tell: (width: number, height: number) => void) {
  return (node: Element): (() => void) => {
    const observer = new ResizeObserver(([entry]) => {
      if (entry) tell(entry.contentRect.width, entry.contentRect.height);
    });
    observer.observe(node);
    return () => {
      observer.disconnect();
    };
  };
}
