/** What is drawn with the chart library, all in one file of its own: see library.ts. */

export { drawCompared } from './compared';
export { drawDeviation } from './deviation';
export { drawHistory } from './history';
export { drawResiduals } from './residuals';
