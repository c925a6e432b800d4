/** The reader's clock, moved on every half minute so that ages stay right. */

export const clock = $state({ now: new Date() });

setInterval(() => {
  clock.now = new Date();
}, 30_000);
