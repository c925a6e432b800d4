/** A vessel, and what is on board. */

import { onCatalogue, translate } from './language';

export const vessel = translate('vessel', {
  back: 'Fleet',
  callSign: 'Call sign',
  flag: 'Flag',
  compass: 'Compass',
  worst: 'Largest deviation',
  rms: 'Residuals',
  rmsHelp: (used: string, rejected: string) => `rms of ${used} samples; ${rejected} left out`,
  lastUpload: 'Last upload',
  lastPosition: 'Last position',
  fieldHelp: (h: string, z: string) => `horizontal ${h}, vertical ${z}`,
  fieldAt: (place: string) => `at ${place}`,
  variation: 'Variation',
  modelLine: (version: number, until: string) => `Model ${version}, data until ${until}`,
  noModelTitle: 'No model yet',
  noModelLead: 'This is what is missing now:',
  noModelHow:
    'Ordinary sailing brings them in: the agent keeps every stretch in which the ship holds a steady heading at speed, away from the berth.',
});

export let vesselTabsLabel = 'About the vessel';
export const vesselTabs = translate('vesselTabs', {
  overview: 'Overview',
  deviation: 'Deviation',
  changes: 'Changes',
  adjustment: 'Adjustment',
  agent: 'Agent',
  settings: 'Settings',
});

export let vesselPanelsLabel = 'On this page';
/** The panels of the vessel's page, short, by their ids. */
export const vesselPanels = translate('vesselPanels', {
  deviation: 'Curve and table',
  card: 'Card',
  book: 'Deviation book',
  trust: 'Trust',
  azimuths: 'Azimuths',
  coverage: 'Coverage',
  parameters: 'Magnetism',
  coefficients: 'Coefficients',
  history: 'Over time',
  changes: 'What changed',
  logbook: 'Logbook',
  residuals: 'Residuals',
  orders: 'Work orders',
  binnacle: 'Binnacle',
  agents: 'On board',
  enrol: 'Enrol',
  particulars: 'Particulars',
  limits: 'Limits',
});

/** What to do about a vessel now. */
export const now = translate('now', {
  finding: 'Finding out what to do…',
  unknown: 'Not known yet',
  unknownWhy: 'The alerts, due dates and work orders of this vessel have not all arrived.',
  nothing: 'Nothing to do now',
  nothingDue: 'No alert asks for anything, no adjustment is due and no order is under way.',
  dueLater: (on: string) => `No alert asks for anything. The next adjustment is due on ${on}.`,
  snoozed: (n: number) => (n === 1 ? 'One alert is snoozed.' : `${n} alerts are snoozed.`),
  notRecorded: 'No adjustment on record',
  toStart: 'Record the date',
  openAlert: 'Open the alert',
  seeChange: 'Before and after',
  openOrder: 'Open the work order',
  order: (state: string, port: string, on: string) => `${state}: ${port}, ${on}`,
  overdue: (on: string) => `Adjustment overdue since ${on}`,
  dueBy: (on: string) => `Adjustment due by ${on}`,
  toSchedule: 'See the schedule',
  noAgent: 'No data from an agent yet',
  noAgentWhy:
    'The agent on board records the compass and sends the data here. It is enrolled with a code that is entered on board.',
  noModel: 'The agent is collecting samples',
  noModelWhy:
    'The first deviation curve comes after some days of sailing on different headings. There is nothing to do until then.',
  toAgent: 'See the agent',
});

/** Deviation over time. */
export const history = translate('history', {
  title: 'Deviation over time',
  lead: 'The deviation on each heading, as if the vessel had been at the last position all along. A change of the ship’s magnetism is a step; the shaded bands are 95 %.',
  headings: 'Headings',
  most: (n: number) => `At most ${n} at once: take one out to draw another.`,
  none: 'No curve yet: it needs a model.',
  noCurve: 'no curve',
  summary: (headings: string, from: string, to: string, steps: number) =>
    `Deviation on ${headings}, from ${from} to ${to}, with ${steps === 1 ? 'one change' : `${steps} changes`}. The table below has the figures.`,
  axisY: 'Deviation',
  table: 'Deviation as a table',
  caption: 'Deviation on each heading by epoch',
  from: 'From',
  until: 'Until',
  now: 'now',
  start: 'the beginning',
  sample: 'Sample within 15° of the heading',
  epoch: 'Deviation by epoch',
  change: 'Change of the ship’s magnetism',
  passing: 'Storm, cargo or other disturbance',
});

export const agents = translate('agents', {
  title: 'On board',
  lead: 'Each installation of the agent reports one compass as one stream.',
  none: 'No agent has been enrolled for this vessel yet.',
  stream: 'Stream',
  version: (v: string) => `agent ${v}`,
  opened: 'Enrolled',
  lastUpload: 'Last upload',
  batches: 'Batches',
  samples: 'Samples',
  waiting: 'waiting for the first batch',
  lastWeek: 'Link, last 7 days',
  sent: (batches: string, octets: string) => `${batches} batches, ${octets} octets`,
  silent: 'nothing came',
  longestWait: 'Longest wait for the link',
  spool: 'Waiting on board',
  spoolEmpty: 'nothing',
  spoolHolds: (batches: string) => (batches === '1' ? '1 batch' : `${batches} batches`),
  notYetSaid: 'not known before the first batch',
  notCarried: 'not known: neither short bursts nor older agents say it',
  budget: 'Budget of the link',
  budgetEnough: 'not short',
  budgetLeft: (percent: string) => `${percent} of a day’s left`,
  budgetOver: (percent: string) => `overdrawn by ${percent} of a day’s`,
  asOf: (when: string) => `as of ${when}`,
  notSaidSince: (when: string) =>
    `as of ${when}; what came later did not say, as short bursts do not`,
  gap: 'A batch before the latest is missing; the agent sends it again.',
  revoked: (when: string) => `Revoked ${when}: this agent may not send until it is enrolled again.`,
  revoke: 'Revoke…',
  revokeQuestion:
    'It may send nothing more until it is enrolled again with a new code. It goes on sampling, and what it has sent stays.',
  revokeConfirm: 'Revoke the agent',
  tally: 'What became of the ten-second windows',
  tallyNone: 'No windows reported yet.',
  windows: 'Windows',
  share: 'Share',
  outcome: 'Outcome',
  reasons: {
    accepted: 'accepted',
    hold_berthed: 'refused: alongside (held by the crew)',
    hold_magnetic_cargo: 'refused: magnetic cargo (held by the crew)',
    hold_degaussing: 'refused: degaussing (held by the crew)',
    clock: 'refused: the ship’s clock jumped',
    no_time: 'refused: no time',
    no_compass: 'refused: no compass heading',
    no_reference: 'refused: neither gyro nor satellite compass',
    not_independent: 'refused: the reference is made of the compass itself',
    unproven_reference: 'refused: the reference is not yet shown to be independent of the compass',
    two_sensors: 'refused: two sensors send as one',
    gnss_interference: 'refused: GNSS interference, and no gyro',
    no_position: 'refused: no position',
    no_speed: 'refused: no speed over ground',
    sparse: 'refused: too few readings',
    slow: 'refused: too slow',
    turning: 'refused: turning',
    settling: 'refused: settling after a turn',
    swinging: 'refused: heading swinging',
    thinned: 'accepted, then left out for want of room or budget',
  } as Record<string, string>,
  otherReason: (name: string) => `refused: ${name.replaceAll('_', ' ')}`,
});

export const enrol = translate('enrol', {
  title: 'Enrol an agent',
  lead: 'Makes a code that one agent on board exchanges for its own key.',
  compass: 'For the compass',
  make: 'Make a code',
  making: 'Making…',
  shownOnce: 'Shown only now. It works once, until',
  onBoard: 'On board, type:',
  another: 'Make another code',
  qr: 'QR code with the command to be typed on board',
});

export const orderPanel = translate('orderPanel', {
  title: 'Adjustment',
  lead: 'Work orders for this compass.',
  none: 'No adjustment is under way.',
  order: 'Order an adjustment',
});

onCatalogue((catalogue) => {
  ({ vesselTabsLabel, vesselPanelsLabel } = catalogue);
});
