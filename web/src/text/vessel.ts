/** A vessel, and what is on board. */

export const vessel = {
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
};

export const vesselPartsLabel = 'On this page';
/** The parts of her page, short, by their ids. */
export const vesselParts = {
  deviation: 'Deviation',
  trust: 'Trust',
  residuals: 'Residuals',
  changes: 'Changes',
  card: 'Card',
  orders: 'Adjustment',
  binnacle: 'Binnacle',
  particulars: 'Particulars',
  limits: 'Limits',
  book: 'Deviation book',
  logbook: 'Logbook',
  coverage: 'Coverage',
  parameters: 'Magnetism',
  coefficients: 'Coefficients',
  agents: 'On board',
};

export const agents = {
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
};

export const enrol = {
  title: 'Enrol an agent',
  lead: 'Makes a code that one agent on board exchanges for its own key.',
  compass: 'For the compass',
  make: 'Make a code',
  making: 'Making…',
  shownOnce: 'Shown only now. It works once, until',
  onBoard: 'On board, type:',
  another: 'Make another code',
  qr: 'QR code with the command to be typed on board',
};

export const orderPanel = {
  title: 'Adjustment',
  lead: 'Work orders for this compass.',
  none: 'No adjustment is under way.',
  order: 'Order an adjustment',
};
