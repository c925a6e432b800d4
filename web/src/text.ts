/**
 * Every English text that the dashboard shows, in one place. A text with a
 * value in it is a function; values come in already written by `format.ts`.
 */

import type {
  AlertCause,
  CargoKind,
  ChangeCause,
  LogbookKind,
  MessageKind,
  ParameterName,
  Severity,
} from './api/types';

export const text = {
  product: 'Binnacle',
  tagline: 'The magnetic compass, corrected at sea',
  noMountPoint: 'index.html has no element with the id "app"',

  skip: 'Skip to content',
  loading: 'Loading…',
  retry: 'Try again',
  cancel: 'Cancel',
  copy: 'Copy',
  copied: 'Copied',
  optional: 'optional',
  utc: 'UTC',

  signIn: {
    title: 'Sign in',
    email: 'E-mail',
    password: 'Password',
    submit: 'Sign in',
    busy: 'Signing in…',
    wrong: 'E-mail or password is wrong.',
    missing: 'Enter e-mail and password.',
  },
  signOut: 'Sign out',

  theme: {
    label: 'Colours',
    auto: 'Auto',
    light: 'Day',
    dark: 'Night',
  },

  live: {
    connecting: 'Connecting',
    live: 'Live',
    lost: 'Not live',
    liveLong: 'Shows new data as it arrives',
    lostLong: 'The live connection is lost; trying again',
  },

  problem: {
    offline: 'The server cannot be reached. Check the connection.',
    offlineStale: (since: string) =>
      `The server cannot be reached. What you see is from ${since}; it is refreshed as soon as the connection is back.`,
    stale: (since: string, detail: string) =>
      `This could not be refreshed (${detail}). What you see is from ${since}.`,
    unexpected: (status: number) => `The server answered with an error (${status}).`,
    unreadable: 'The server answered in a form that this page cannot read.',
    signedOut: 'Your session has ended. Sign in again.',
    notFoundTitle: 'Nothing here',
    notFound: 'There is no such page, or it belongs to another fleet.',
    toVessels: 'To the vessels',
    title: 'This could not be shown',
  },

  alerts: {
    title: 'Alerts',
    navigation: 'Pages',
    badge: ' alerts that nobody has acknowledged',
    lead: 'What someone should know of or act on. An alert clears itself when its cause is over.',
    unacknowledged: (n: number) => (n === 0 ? 'acknowledged' : `${n} to acknowledge`),
    emptyTitle: 'Nothing to see to',
    empty: 'No vessel has an open alert.',
    severity: {
      notice: 'Notice',
      warning: 'Warning',
      critical: 'Critical',
    } satisfies Record<Severity, string>,
    cause: {
      deviation_over_limit: 'Deviation over the limit',
      reference_fault: 'Gyro and satellite compass disagree',
      compass_fault: 'The compass sticks',
      lightning_or_shock: 'Magnetism changed: lightning or a shock',
      magnetic_cargo: 'Magnetism changed: magnetic cargo',
      drift: 'Magnetism drifts',
      local_anomaly: 'Local anomaly',
      magnetic_storm: 'Magnetic storm',
      berth_steel: 'Steel at the berth',
      unknown_change: 'Magnetism changed: cause unknown',
      reported_aboard: 'Compass and gyro parted, says the ship',
      silent_agent: 'No word from the vessel',
      cloned_agent: 'Two computers send as one agent',
      no_model: 'No model of the compass yet',
      wide_band: 'The model is too uncertain',
    } satisfies Record<AlertCause, string>,
    since: (when: string) => `since ${when}`,
    todo: 'What to do',
    evidence: 'What shows it',
    acknowledged: (who: string, when: string) => `Acknowledged by ${who}, ${when}`,
    cleared: (who: string | null, when: string) =>
      who === null ? `Over since ${when}` : `Cleared by ${who}, ${when}`,
    acknowledge: 'Acknowledge',
    note: 'Note',
    clear: 'Clear',
    clearReason: 'Why it is over',
    clearMissing: 'Say why it is over.',
    confirmAcknowledge: 'Acknowledge the alert',
    confirmClear: 'Clear the alert',
    saidAcknowledged: 'The alert is acknowledged.',
    saidCleared: 'The alert is cleared.',
    clearedTitle: 'Cleared lately',
    toMail: 'Mail',
    toWebhooks: 'Webhooks',
  },

  webhooks: {
    title: 'Webhooks',
    lead: 'Programs of yours that are told of alerts. Each message is signed; how to verify it stands in docs/webhooks.md.',
    none: 'No program is told of alerts yet.',
    noneViewer: 'An administrator of your company makes webhooks.',
    add: 'Add a webhook',
    url: 'Address',
    kinds: 'Told of',
    urlMissing: 'Enter an address that begins with https://.',
    kindsMissing: 'Choose at least one.',
    create: 'Make the webhook',
    secretTitle: 'Its secret',
    secretLead: 'Copy it now: it is not shown again. Messages are signed with it.',
    done: 'Done',
    off: 'Off',
    on: 'On',
    switchOff: 'Switch off',
    switchOn: 'Switch on',
    test: 'Send a test',
    tested: 'A test is on its way.',
    remove: 'Remove',
    removeQuestion: 'Remove this webhook, with what it was still to be told?',
    removeConfirm: 'Remove the webhook',
  },

  outbox: {
    title: 'Latest messages',
    none: 'Nothing was sent yet.',
    kind: {
      'alert.raised': 'Alert raised',
      'alert.updated': 'Severity changed',
      'alert.acknowledged': 'Alert acknowledged',
      'alert.cleared': 'Alert cleared',
      test: 'Test',
    } satisfies Record<MessageKind, string>,
    states: { pending: 'waiting', delivered: 'delivered', dead: 'given up' },
    pending: (n: number) => `${n} waiting`,
    dead: (n: number) => `${n} given up`,
    attempts: (n: number) => (n === 1 ? '1 try' : `${n} tries`),
    again: 'Send again',
  },

  mail: {
    title: 'Mail',
    lead: 'Who gets alerts by mail: when an alert is raised, when it gets worse, and when it is over.',
    notSetUp:
      'This server was not told how to send mail. Whoever runs it sets --smtp-url, --mail-from and --public-url.',
    none: 'Nobody gets mail yet.',
    noneViewer: 'Nobody gets mail yet. An administrator of your company adds addresses.',
    add: 'Add an address',
    address: 'Address',
    addressMissing: 'Enter an address like name@example.com.',
    severity: 'Alerts',
    from: {
      notice: 'All alerts',
      warning: 'Warnings and critical alerts',
      critical: 'Critical alerts only',
    } satisfies Record<Severity, string>,
    create: 'Add the address',
    severityOf: (address: string) => `Alerts for ${address}`,
    test: 'Send a test',
    tested: 'A test is on its way.',
    changed: 'Changed.',
    remove: 'Remove',
    removeQuestion: 'Send this address no more mail?',
    removeConfirm: 'Remove the address',
  },

  vessels: {
    title: 'Vessels',
    fleet: (operator: string) => `Fleet of ${operator}`,
    name: 'Vessel',
    lastUpload: 'Last upload',
    position: 'Position',
    worst: 'Largest deviation',
    fit: 'Fit',
    onHeading: (heading: string) => `on ${heading}`,
    band: (band: string) => `${band} (95 %)`,
    model: (version: number) => `Model ${version}`,
    rms: (rms: string) => `residuals ${rms} rms`,
    noModel: 'No model yet',
    noUpload: 'nothing uploaded yet',
    noPosition: 'no position yet',
    shown: (n: number) => (n === 1 ? '1 vessel' : `${n} vessels`),
    emptyTitle: 'No vessels yet',
    emptyAdmin:
      'Add the first vessel; then enrol the agent on board, and its compass begins to be measured.',
    emptyViewer: 'An administrator of your company adds vessels.',
    add: 'Add a vessel',
    addTitle: 'Add a vessel',
    fieldName: 'Name',
    fieldImo: 'IMO number',
    fieldCallSign: 'Call sign',
    fieldFlag: 'Flag',

    create: 'Add vessel',
    creating: 'Adding…',
    nameMissing: 'A vessel needs a name.',
    grade: {
      small: 'small',
      notable: 'notable',
      large: 'large',
    },
    gradeLong: {
      small: 'Below 3° on every heading',
      notable: 'Between 3° and 5° on some heading',
      large: 'Above 5° on some heading: most flags ask for an adjustment',
    },
  },

  vessel: {
    back: 'All vessels',
    imo: 'IMO',
    callSign: 'Call sign',
    flag: 'Flag',
    compass: 'Compass',
    worst: 'Largest deviation',
    rms: 'Residuals',
    rmsHelp: (used: string, rejected: string) => `rms of ${used} samples; ${rejected} left out`,
    lastUpload: 'Last upload',
    lastPosition: 'Last position',
    fieldHelp: (h: string, z: string) => `horizontal ${h}, vertical ${z}`,
    variation: 'Variation',
    modelLine: (version: number, until: string) => `Model ${version}, data until ${until}`,
    noModelTitle: 'No model yet',
    noModelLead: 'This is what is missing now:',
    noModelHow:
      'Ordinary sailing brings them in: the agent keeps every stretch in which the ship holds a steady heading at speed, away from the berth.',
  },

  deviation: {
    title: 'Deviation',
    lead: 'What the compass is off the magnetic heading: magnetic = compass + deviation, east positive.',
    axisX: 'Compass heading',
    axisY: 'Deviation',
    band: '95 % band',
    curve: 'Deviation',
    used: 'Sample',
    unused: 'Left out of the fit',
    legend: 'Legend',
    samples: 'Samples',
    show: {
      here: 'At this place',
      measured: 'As measured',
      none: 'None',
    },
    showLong: {
      here: 'Samples are brought to this place: each stands as far from the curve as it was from the model where it was taken.',
      measured:
        'Samples stand at the deviation measured where they were taken, which differs from the deviation here.',
      none: '',
    },
    drawn: (drawn: string, all: string) => `${drawn} of ${all} samples drawn.`,
    place: 'Place and time',
    latitude: 'Latitude',
    longitude: 'Longitude',
    date: 'Date',
    apply: 'Show',
    reset: 'Back to the last position',
    choose: 'Choose another place',
    latitudeWrong: 'Latitude: write it as 54 30 N or 54.5.',
    longitudeWrong: 'Longitude: write it as 018 40 E or 18.67.',
    dateWrong: 'Date: choose a day.',
    at: (place: string, day: string) => `At ${place} on ${day}`,
    variationThere: (variation: string) => `variation ${variation}`,
    fieldThere: (h: string, z: string) => `field ${h} horizontal, ${z} vertical`,
    summary: (max: string, on: string, min: string, onMin: string) =>
      `Deviation against compass heading, from ${min} on ${onMin} to ${max} on ${on}. The table of deviations has the same figures.`,
    bandSummary: (narrow: string, wide: string) =>
      narrow === wide ? `Band ${narrow} everywhere.` : `Band from ${narrow} to ${wide}.`,
    tip: (compass: string, deviation: string, band: string, magnetic: string) =>
      `Compass ${compass}\n${deviation} ${band}\nMagnetic ${magnetic}`,
    noBand: 'This model came without errors: no band can be given.',
    uncertain: (wide: string) =>
      `The band is ${wide} wide or more on some headings: data from this magnetic latitude are missing.`,
  },

  table: {
    title: 'Table of deviations',
    caption: (place: string, day: string) =>
      `Deviation every 15° of compass heading at ${place} on ${day}`,
    compass: 'Compass',
    magnetic: 'Magnetic',
    point: 'Point',
    deviation: 'Deviation',
    band: '95 %',
  },

  residuals: {
    title: 'Residuals over time',
    lead: 'Measured less predicted deviation. A step or a slope here means that the ship’s magnetism, or a reference, has changed.',
    axisY: 'Residual',
    mean: 'Daily mean',
    meanWeekly: 'Weekly mean',
    summary: (n: string, rms: string, from: string, to: string) =>
      `${n} residuals, ${rms} rms, from ${from} to ${to}. The table below has them by day or week.`,
    table: 'Residuals as a table',
    caption: 'Residuals by interval, samples used in the fit',
    from: 'From',
    samples: 'Samples',
    meanColumn: 'Mean',
    rmsColumn: 'rms',
    none: 'No residuals yet: they need a model.',
    period: 'Period',
    days: (n: number) => `${n} days`,
    truncated: (n: string) => `Only the last ${n} samples of this period are shown.`,
  },

  changes: {
    title: 'What changed',
    lead: 'The ship’s magnetism stays the same through an epoch. What ended one, or disturbed the compass for a while, is found in the samples and stands here, the latest first.',
    none: (since: string) => `No change found since ${since}, when the first sample was taken.`,
    noneYet: 'Nothing has been analysed yet. Changes are looked for as soon as samples arrive.',
    list: 'Changes, epochs and reports, the latest first',
    cause: {
      lightning_or_shock: 'Lightning or a shock',
      magnetic_cargo: 'Magnetic cargo',
      adjustment_or_repair: 'Adjustment or repair',
      drift: 'Slow drift',
      compass_fault: 'The compass sticks',
      reference_fault: 'Gyro or satellite compass at fault',
      local_anomaly: 'Local anomaly',
      magnetic_storm: 'Magnetic storm',
      berth_steel: 'Steel at the berth',
      unknown: 'A change of unknown cause',
    } satisfies Record<ChangeCause, string>,
    unconfirmed: 'not certain yet',
    overSince: (when: string) => `over since ${when}`,
    between: (earliest: string, latest: string) => `some time between ${earliest} and ${latest}`,
    found: (later: string) => `Found ${later} after that.`,
    foundAtOnce: 'Found at once.',
    deviation: (degrees: string) =>
      `Deviation changed by ${degrees} on the heading where it changed most.`,
    notHers: 'The ship’s own magnetism did not change.',
    step: (foreAft: string, athwart: string) =>
      `Permanent magnetism changed by ${foreAft} fore-and-aft (forward positive) and ${athwart} athwartships (starboard positive).`,
    why: 'Why this cause',
    likelihoods: 'How likely each cause is',
    likelihood: (percent: string, words: string) => `${percent}, ${words}`,
    words: {
      certain: 'all but certain',
      likely: 'likely',
      possible: 'possible',
      unlikely: 'unlikely',
    },
    show: 'Curve before and after',
    hide: 'Hide the curve',
    showOf: (what: string, when: string) => `Curve before and after: ${what}, ${when}`,
    before: 'Before',
    after: 'After',
    difference: 'Change',
    noCurve: {
      before: 'There is no model from before: only the curve after it is shown.',
      after:
        'There is no model from after it yet: only the curve before is shown, and it no longer holds.',
      both: 'There is no model from before nor from after: no curve can be shown.',
    },
    compared: (place: string) => `Both at ${place}, where she was last, with their 95 % bands.`,
    comparedSummary: (most: string, on: string) =>
      `Deviation against compass heading before and after. They part most, by ${most}, on ${on}.`,
    tip: (compass: string, before: string, after: string) =>
      `Compass ${compass}\nbefore ${before}\nafter ${after}`,
    table: 'The curves as a table',
    tableCaption: 'Deviation before and after, every 30° of compass heading',
    epochBegan: 'A new epoch began',
    epochFirst: 'First sample',
    epochResumes: (since: string) => `Her magnetism is again what it was ${since}.`,
    fromTheStart: 'at first',
    sinceDay: (day: string) => `from ${day} on`,
    epochModel: (samples: string, rms: string) =>
      `Model of ${samples} samples, residuals ${rms} rms.`,
    epochNoModel: 'No model of this epoch yet.',
    reported: (what: string) => `Reported: ${what}`,
  },

  logbook: {
    title: 'Logbook',
    lead: 'What bears on the ship’s magnetism, reported ashore or on board. What was wrong is withdrawn and stays readable.',
    report: 'Report',
    reportTitle: 'Report what happened',
    amendTitle: 'Amend the entry',
    closeTitle: 'When did it end?',
    none: 'Nothing has been reported yet. Report lightning, magnetic cargo, time alongside, and work on ship or compass: it tells a change of magnetism from an error, and keeps what is not the ship’s own out of her model.',
    noneViewer: 'Nothing has been reported yet. Administrators report here, officers on board.',
    kind: 'What',
    from: 'When',
    to: 'Until',
    fromOf: { magnetic_cargo: 'Loaded', berth: 'Alongside from' },
    toOf: { magnetic_cargo: 'Discharged', berth: 'Sailed' },
    cargo: 'Cargo',
    hatch: 'Hatch',
    port: 'Port',
    compass: 'Compass',
    wholeShip: 'The whole ship',
    note: 'Remarks',
    submit: 'Report',
    save: 'Save',
    saving: 'Saving…',
    fromMissing: 'Say when it happened.',
    toWrong: 'The end is not a time.',
    toBeforeFrom: 'It cannot end before it begins.',
    amend: 'Amend',
    withdraw: 'Withdraw',
    close: { magnetic_cargo: 'Discharged…', berth: 'Sailed…' },
    open: { magnetic_cargo: 'on board', berth: 'alongside' },
    since: (begin: string) => `since ${begin}`,
    inHatch: (hatch: string) => `hatch ${hatch}`,
    earlier: 'Show earlier entries',
    reported: 'Reported.',
    amended: 'The entry has been amended.',
    isWithdrawn: 'The entry has been withdrawn.',
    withdrawQuestion:
      'Withdraw this entry? It stays in the logbook, struck through, and counts no more. It cannot be brought back.',
    withdrawReason: 'Why',
    withdrawConfirm: 'Withdraw the entry',
    withdrawCancel: 'Keep it',
    by: {
      user: (name: string, at: string) => `Reported by ${name}, ${at}.`,
      agent: (name: string, at: string) =>
        name === ''
          ? `Reported on board, here ${at}.`
          : `Reported on board by ${name}, here ${at}.`,
      firm: (name: string, at: string) => `Reported by ${name}, adjuster, ${at}.`,
    },
    revised: (name: string, at: string) =>
      name === '' ? `Amended on board, ${at}.` : `Amended by ${name}, ${at}.`,
    withdrawn: (name: string, at: string) =>
      name === '' ? `Withdrawn on board, ${at}.` : `Withdrawn by ${name}, ${at}.`,
    groups: {
      cargo: 'Cargo and berth',
      blow: 'What struck her',
      work: 'Work on ship and compass',
      rest: 'Anything else',
    },
    kinds: {
      magnetic_cargo: 'Magnetic cargo',
      berth: 'Alongside',
      lightning: 'Lightning',
      shock: 'Grounding, collision or shock',
      adjustment: 'Adjustment',
      corrector_change: 'Correctors changed',
      compass_moved: 'Compass moved',
      repair: 'Repair',
      dry_docking: 'Dry-docking',
      welding: 'Welding',
      degaussing: 'Degaussing',
      note: 'Remark',
    } satisfies Record<LogbookKind, string>,
    cargoes: {
      steel: 'Steel',
      scrap: 'Scrap',
      containers: 'Containers',
      other: 'Other cargo',
    } satisfies Record<CargoKind, string>,
    effects: {
      magnetic_cargo:
        'Samples from loading to discharge are left out of the model; without a discharge, all from loading on.',
      berth: 'Samples taken alongside are left out of the model.',
      lightning: 'Changes no sample: a strike that altered the magnetism shows in the residuals.',
      shock: 'Changes no sample: a blow that altered the magnetism shows in the residuals.',
      adjustment: 'A new epoch begins: what was learnt before does not count for the compass now.',
      corrector_change:
        'A new epoch begins: what was learnt before does not count for the compass now.',
      compass_moved:
        'A new epoch begins: what was learnt before does not count for the compass now.',
      repair: 'A new epoch begins: permanent magnetism is learnt anew.',
      dry_docking: 'A new epoch begins: permanent magnetism is learnt anew.',
      welding: 'A new epoch begins: permanent magnetism is learnt anew.',
      degaussing: 'A new epoch begins: permanent magnetism is learnt anew.',
      note: 'Changes nothing in the model.',
    } satisfies Record<LogbookKind, string>,
  },

  coverage: {
    title: 'Coverage',
    lead: 'Samples by compass heading and magnetic latitude. Headings fix the curve where the ship has been; different magnetic latitudes fix it elsewhere.',
    caption: 'Number of samples by compass heading (columns) and magnetic latitude (rows)',
    band: 'Magnetic latitude',
    range: (from: string, to: string) => `${from} to ${to}`,
    total: 'All',
    summaryAll: (bands: number) =>
      `All headings are covered; ${bands === 1 ? 'one band' : `${bands} bands`} of magnetic latitude.`,
    summaryGaps: (gaps: string) => `No samples yet on compass headings ${gaps}.`,
    none: 'No samples yet.',
    oneBand:
      'All samples are from one band of magnetic latitude: permanent and induced magnetism cannot be told apart yet, and the curve at a distant place rests on experience with other ships.',
    north: (v: string) => `${v} N`,
    south: (v: string) => `${v} S`,
  },

  sailNext: {
    title: 'What to sail next',
    lead: 'Where a watch would teach most about this compass: four hours on one compass heading; three watches are on three successive days. The band is the 95 % band, as a mean over all headings.',
    here: 'In these waters',
    elsewhere: 'For other waters',
    between: (from: string, to: string) => `Between ${from} and ${to}`,
    anyHeading: 'On any heading',
    latitudes: (from: string, to: string) => `Between ${from} and ${to}, magnetic latitude`,
    and: (before: string, last: string) => `${before} and ${last}`,
    gainHere: (now: string, one: string, three: string) =>
      `A watch would narrow the band from ${now} to ${one}, three watches on one of these headings to ${three}.`,
    gainElsewhere: (now: string, heading: string, one: string, headings: string, three: string) =>
      `A watch on about ${heading} there would narrow the band in other waters from ${now} to ${one}, three watches (${headings}) to ${three}.`,
    elsewhereNow: (mean: string, worst: string) =>
      `In other magnetic latitudes the band is ${mean} as a mean, ${worst} at worst.`,
    nothing: (band: string, floor: string, most: string) =>
      `Neither one watch nor three would narrow the band noticeably. It is ${band}, and the reference’s own constant error, which no heading shows, is ${floor} by itself: nothing sailed narrows the band by more than ${most}.`,
    reference:
      'To narrow it further, check the gyro or satellite compass against a transit, the sun’s bearing or a second reference.',
    magneticLatitude:
      'Magnetic latitude follows the dip of the earth’s field; it differs from the chart’s latitude by some ten degrees.',
  },

  trust: {
    title: 'How far to trust the curve',
    lead: 'The 95 % band: nineteen times in twenty the deviation is no further off than this.',
    hereTitle: 'In these waters',
    thereTitle: 'At the place chosen',
    here: (worst: string, least: string, best: string) =>
      `at worst, on ${worst}; ${least} at best, on ${best}.`,
    hereEven: 'on every heading.',
    hereNone: 'This model came without errors: how far it may be off is not known.',
    elsewhereTitle: 'In other waters, up to',
    elsewhere: (limit: string, good: string, worst: string, at: string) =>
      `About ${limit} or better on every heading ${good} magnetic latitude; elsewhere up to ${worst}, at worst ${at}.`,
    everywhereGood: (limit: string, all: string) =>
      `About ${limit} or better on every heading wherever ships sail: ${all} magnetic latitude.`,
    nowhereGood: (limit: string, at: string) =>
      `No magnetic latitude is known to ${limit} on every heading yet. It is worst ${at}.`,
    between: (from: string, to: string) => `between ${from} and ${to}`,
    worthTitle: 'Her samples are worth',
    worth: (samples: string, effective: string) =>
      `${samples} samples, worth ${effective} with independent errors: a gyro’s errors last for hours and days, the variation’s for tens of miles, so that samples repeat each other.`,
    referencesTitle: 'Gyro and satellite compass',
    apart: (angle: string) => `${angle} apart`,
    gyroAhead: (angle: string, pairs: string) =>
      `The gyro usually reads ${angle} more than the satellite compass (${pairs} samples with both).`,
    gyroBehind: (angle: string, pairs: string) =>
      `The gyro usually reads ${angle} less than the satellite compass (${pairs} samples with both).`,
    constantLeft: (band: string) =>
      `No heading shows which of them is right: ${band} for that is in every band.`,
    oneReference: 'Only one',
    oneReferenceLong: (band: string) =>
      `No sample came with both, so that neither checks the other; ${band} for a constant error of the reference is in every band.`,
    notCompared: 'Not compared',
    notComparedLong: (pairs: string, band: string) =>
      `Only ${pairs} samples came with both; ${band} for a constant error of the reference is in every band.`,
    droppedTitle: 'Readings that were not believed',
    dropped: (gyro: string, satellite: string) =>
      `The gyro was left out in ${gyro} samples, the satellite compass in ${satellite}.`,
    droppedWhy: (beyond: string) =>
      `One of them is held to have failed where it stood still while the ship turned, or where the two were further than ${beyond} from their usual difference. Then the magnetic compass decides between them; where it cannot, both are left out.`,
    droppedStuck: 'It stood still while the ship turned.',
    oneMagneticLatitude:
      'Her samples are from too narrow a range of magnetic latitudes to tell permanent from induced magnetism. The curve is good where she has been; far from there it leans on what is usual in ships until she has sailed there.',
    fewSamples:
      'Her latitudes would tell permanent from induced magnetism, but her samples are too few yet. The curve is good where she has been; elsewhere it leans on what is usual in ships until more samples come in, which needs nothing but sailing on.',
    noTimes:
      'The rows have no times, so that nobody knows which of them share one error of the gyro. The band takes rows on like headings for half a day’s.',
    largeResiduals: (residual: string) =>
      `Measured and predicted deviation usually differ by ${residual}, more than sound instruments leave. Check compass, gyro and satellite compass, and which input is taken for which, before these figures are believed.`,
    longGap: (days: string, last: string) =>
      `Before the last samples there were none for ${days} days. The curve is for ${last}, and its band allows for what a ship may change in such a time.`,
    unknown: 'This page does not know one of this model’s cautions: load it anew.',
    weakField: (h: string) =>
      `Some samples are from waters with a horizontal field of only ${h}. There a compass is sluggish, small fields disturb it much, and its heading needs checking often.`,
    tableTitle: 'The band by magnetic latitude',
    caption: 'Half the 95 % band on the worst heading, by magnetic latitude from north to south',
    waters: 'Magnetic latitude',
    band: 'Up to',
    sailed: 'she has samples from there',
    mark: 'here',
    noAnswer: 'no answer',
    noAnswerLong:
      'No answer: on some heading the ship’s magnetism would outweigh the earth’s field there.',
  },

  refusal: {
    withdrawn: (since: string, reason: string) =>
      `The last card has not held since ${since} (${reason}): do not steer by it.`,
    todo: 'What to do',
    tooFewSamples: (found: string, needed: string) =>
      `${found} samples can be used so far; at least ${needed} are needed.`,
    tooFewSamplesTodo:
      'Keep sailing: the agent takes a sample from every ten minutes or so on a steady heading at speed, away from the berth. If few come in, what became of the ten-second windows stands under “On board”, with the reasons.',
    noReference: (readings: string) =>
      `None of the ${readings} samples has a heading by gyro or satellite compass to hold the compass against.`,
    noReferenceTodo:
      'Check on board that a gyro or satellite compass is connected, and which sentence is taken for it.',
    noWeight: (samples: string) => `The weight is 0 in all of ${samples} samples.`,
    noWeightTodo: 'Give the rows that are to count a weight above 0.',
    contradictory: (residual: string, allowed: string) =>
      `Measured and predicted deviation differ by ${residual}, where no instruments leave more than ${allowed}: no ship’s magnetism explains these samples.`,
    contradictoryTodo:
      'Check on board which input is taken for the compass and which for the gyro, and in a file the sign of the variation, which is positive to the east.',
    tooFewHeadings: (found: number, needed: number, gap: string, allowed: string) =>
      `Samples are on ${found} of 24 sectors of 15°, with a gap of ${gap} between them. At least ${needed} sectors are needed, and no gap wider than ${allowed}.`,
    missing: (ranges: string) => `Missing: ${ranges}.`,
    tooFewHeadingsTodo:
      'Steer the missing headings, marked empty under “Coverage”: ten minutes steady on each will do, such as when waiting for a pilot or a berth, or on the passage back.',
    fieldTooWeak: (strongest: string, needed: string) =>
      `All samples are from waters with a horizontal field of at most ${strongest}; a magnetic compass needs ${needed} or more to steer by.`,
    fieldTooWeakTodo:
      'Nothing is wrong with the compass. A model comes with samples from lower magnetic latitudes; until then steer by the gyro.',
    ambiguousHeadings: (h: string) =>
      `The samples ask for so much magnetism that, at a horizontal field of ${h}, one compass heading would belong to several courses.`,
    ambiguousHeadingsTodo:
      'Do not rely on this compass. Look for correctors that are missing or turned about and for steel near the binnacle, check that the agent reads the right instrument, and have the compass adjusted.',
    oneMagneticLatitude:
      'All samples are from one magnetic latitude, where permanent and induced magnetism cannot be told apart.',
    oneMagneticLatitudeTodo: 'A passage to another magnetic latitude tells them apart.',
    referencesDisagree: (apart: string, allowed: string) =>
      `Gyro and satellite compass differ by ${apart} throughout; ${allowed} is the most that alignment explains. One of them is wrong, and headings cannot tell which.`,
    referencesDisagreeTodo:
      'Check both against a transit or the sun’s bearing: the satellite compass for its antenna’s alignment and offset, the gyro for its latitude and speed settings. Put the wrong one right, or leave it out on board; a model comes with the samples after that.',
    referenceStuck: (readings: string) =>
      `The only reference stood still in ${readings} readings while the compass turned: it is stuck, or another source is taken for it.`,
    referenceStuckTodo:
      'Check on board which instrument and which sentence is taken for the gyro or satellite compass, and that it follows the ship round. A model comes with the samples after that.',
    notConverged: 'The samples contradict each other, or any ship.',
    notConvergedTodo:
      'Check on board that compass, gyro and satellite compass are taken from the right instruments, and report in the logbook what changed the ship’s magnetism meanwhile: cargo, repairs, lightning, correctors.',
    none: 'No sample has been analysed yet.',
    noneTodo:
      'Have the agent on board enrolled if that is not done. Once the ship is at sea, samples come in with its uploads.',
  },

  parameters: {
    title: 'The ship’s magnetism',
    lead: 'The seven quantities behind the curve, each in proportion to the mean shielding λ, and the constant.',
    name: 'Quantity',
    value: 'Value ± standard error',
    basis: 'Known from',
    bases: {
      own: 'her own headings',
      mostly: 'mostly her own',
      little: 'mostly ships at large',
      ships: 'ships at large',
      unknown: 'not stated',
    },
    shareTitle: (percent: string) => `${percent} of what was uncertain before has been settled`,
    names: {
      bx_nt: ['Permanent fore-and-aft magnetism', 'P, forward positive'],
      chi13: ['Fore-and-aft, induced by the vertical field', 'c'],
      by_nt: ['Permanent athwartship magnetism', 'Q, starboard positive'],
      chi23: ['Athwartship, induced by the vertical field', 'f'],
      chi11_minus_chi22: ['Horizontal soft iron, fore-and-aft less athwartship', 'a − e'],
      chi12: ['Fore-and-aft, induced by the athwartship field', 'b'],
      chi21: ['Athwartship, induced by the fore-and-aft field', 'd'],
      constant_deg: ['Constant', 'alignment, reference and variation offsets'],
    } satisfies Record<ParameterName, [string, string]>,
    summary: (own: number, all: number) =>
      own === all
        ? 'Her own headings tell all of them apart.'
        : `Her own headings tell ${own} of the ${all} apart. Where she has been the curve needs only their sums, the coefficients.`,
    help: 'What they do not tell leans on what is usual in ships, or on what she was before a repair.',
    about: 'What some are known for only together',
    pairs:
      'One magnetic latitude tells P + c Z and Q + f Z, the fields of coefficients B and C, much better than their parts; sailing to another tells the parts.',
    constant:
      'Headings cannot tell the constant from A = (d − b)/2, nor the lubber line’s offset from that of the reference or the variation: only the whole is known, shown as coefficient A (includes alignment, reference and variation offsets). E is half of b + d.',
    condition: (ratio: string) =>
      `By her own data the least known combination is ${ratio} times less certain than the best known.`,
    conditionOpen: 'Her own data leave one combination quite open.',
    details: 'Where these figures come from',
    hash: 'Input',
    estimator: 'Estimator',
    created: 'Computed',
    epoch: 'Epoch',
    epochOpen: 'now',
    epochStart: 'the beginning',
    to: 'to',
  },

  coefficients: {
    title: 'Coefficients',
    lead: 'At the last position. Exact ones, with their standard errors, give the curve by the exact formula; handbook ones are the five-term approximation that older tables and adjusters use.',
    name: 'Coefficient',
    exact: 'Exact',
    handbook: 'Handbook',
    meaning: {
      A: 'the same on all headings (includes alignment, reference and variation offsets)',
      B: 'fore-and-aft magnetism: greatest on east and west',
      C: 'athwartship magnetism: greatest on north and south',
      D: 'soft iron along and across: quadrantal, greatest on intercardinals',
      E: 'soft iron askew: quadrantal, greatest on cardinals',
    },
  },

  agents: {
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
    gap: 'A batch before the latest is missing; the agent sends it again.',
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
    } as Record<string, string>,
    otherReason: (name: string) => `refused: ${name.replaceAll('_', ' ')}`,
  },

  enrol: {
    title: 'Enrol an agent',
    lead: 'Makes a code that one agent on board exchanges for its own key.',
    compass: 'For the compass',
    make: 'Make a code',
    making: 'Making…',
    shownOnce: 'Shown only now. It works once, until',
    onBoard: 'On board, type:',
    another: 'Make another code',
  },

  document: {
    vessels: 'Vessels · Binnacle',
    vessel: (name: string) => `${name} · Binnacle`,
    signIn: 'Sign in · Binnacle',
    notFound: 'Nothing here · Binnacle',
    alerts: 'Alerts · Binnacle',
    mail: 'Mail · Binnacle',
    webhooks: 'Webhooks · Binnacle',
  },
};
