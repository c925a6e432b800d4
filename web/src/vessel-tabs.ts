/** The tabs of a vessel's page, and what stands on each. Pure. */

export const vesselTabs = [
  'overview',
  'deviation',
  'changes',
  'adjustment',
  'agent',
  'settings',
] as const;
export type VesselTab = (typeof vesselTabs)[number];

/** The panels of each tab, by their ids and as they come on the page. */
export const panelsOf = {
  overview: [],
  deviation: [
    'deviation',
    'card',
    'book',
    'trust',
    'azimuths',
    'coverage',
    'parameters',
    'coefficients',
  ],
  changes: ['history', 'changes', 'logbook', 'residuals'],
  adjustment: ['orders', 'binnacle'],
  agent: ['agents', 'enrol'],
  settings: ['particulars', 'limits'],
} as const satisfies Record<VesselTab, readonly string[]>;

export type VesselPanel = (typeof panelsOf)[VesselTab][number];

/** The tab that the last part of an address names; none where it names none. */
export const tabNamed = (word: string): VesselTab | undefined =>
  vesselTabs.find((tab) => tab === word && tab !== 'overview');

/** The tab that a panel stands on; none where there is no such panel. */
export const tabOf = (panel: string): VesselTab | undefined =>
  vesselTabs.find((tab) => panelsOf[tab].some((id) => id === panel));
