/**
 * All that one vessel's page shows, and how it is asked for.
 *
 * What always holds: what is seen first is asked for first, and what stands on a tab when
 * that is opened; what is about a compass is that of the one chosen, her first until then.
 */

import {
  findAtAGlance,
  findCoverage,
  findDeviation,
  findModel,
  findPicture,
  findPrior,
  findTimeline,
  findVessel,
  listAgents,
  listAzimuths,
  listCallsSince,
  listLogbook,
  listLogbookSince,
  listVesselNeeds,
} from '../api/client';
import { gathered, live } from '../api/live.svelte';
import { findOrder, listOrders } from '../api/orders';
import { findSchedule } from '../api/schedule';
import type {
  AdjustmentNeed,
  AgentStream,
  Azimuth,
  Coverage,
  FleetVessel,
  LogbookEntry,
  ModelVersion,
  PortCall,
  Prior,
  SamplePicture,
  SchedulePlan,
  Timeline,
  Vessel,
  WorkOrder,
  WorkOrderSummary,
} from '../api/types';
import { inOrder } from '../orders/order';
import { foretoldOf } from '../science/foretold';
import type { VesselTab } from '../vessel-tabs';
import { whereabouts, type At } from '../whereabouts';
import { PlacedDeviation } from './placed.svelte';
import { Resource } from './resource.svelte';
import { times } from './times.svelte';

const dayMs = 86_400_000;
/** Lines of the logbook and azimuths at first, and more at a time. */
const logbookStep = 20;
/** A fleet that catches up sends many batches; the page follows at its own pace. */
const [lightMs, heavyMs] = [1_500, 3_000];

/** Parts that are about the compass chosen, and those about the vessel. */
const ofCompass = ['model', 'curve', 'coverage', 'timeline', 'picture', 'happened'] as const;
type Part = (typeof ofCompass)[number] | 'agents' | 'logbook' | 'azimuths';
const partsOf: Record<VesselTab, readonly Part[]> = {
  overview: ['model', 'curve', 'picture'],
  deviation: ['model', 'curve', 'picture', 'coverage', 'happened', 'azimuths'],
  changes: ['model', 'timeline', 'picture', 'happened', 'logbook'],
  adjustment: ['model'],
  agent: ['agents'],
  settings: [],
};

export class ShownVessel {
  vessel = new Resource<Vessel>();
  needs = new Resource<AdjustmentNeed[]>();
  glance = new Resource<FleetVessel | undefined>();
  orders = new Resource<WorkOrderSummary[]>();
  /** What is planned for the whole fleet; nothing before the first plan. */
  plan = new Resource<SchedulePlan | null>();
  model = new Resource<ModelVersion>();
  /** What the model started from. */
  prior = new Resource<Prior>();
  picture = new Resource<SamplePicture>();
  coverage = new Resource<Coverage>();
  timeline = new Resource<Timeline>();
  agents = new Resource<AgentStream[]>();
  logbook = new Resource<{ items: LogbookEntry[]; truncated: boolean }>();
  azimuths = new Resource<{ items: Azimuth[]; truncated: boolean }>();
  /** What was reported and where she called in the period that is shown. */
  happened = new Resource<{ entries: LogbookEntry[]; calls: PortCall[] }>();
  /** The order that foretold the model, if one did. */
  #foretelling = new Resource<WorkOrder>();

  compass = $state<string | undefined>();
  /** Days of residuals. */
  period = $state(90);
  #logbookLines = logbookStep;
  #azimuthLines = logbookStep;

  readonly id: string;
  #named: string | undefined;
  placed: PlacedDeviation;

  #where = $derived(whereabouts(this.picture.value?.dots, this.happened.value?.calls ?? []));
  foretold = $derived(
    foretoldOf(this.model.value, this.orders.value ?? [], this.#foretelling.value),
  );
  noModelYet = $derived(this.model.problem?.kind === 'no-model-yet');

  /** `named` is the compass that the address names, hers or not. */
  constructor(id: string, named?: string) {
    this.id = id;
    this.#named = named;
    this.placed = new PlacedDeviation((place) => findDeviation(id, this.compass, place));
  }

  /** An instant as the reader wants it, where she was then. */
  at: At = (value, port) => times.at(value, port ? { port } : this.#where(value));

  loadVessel = () => this.vessel.load(() => findVessel(this.id));
  loadNeeds = () => this.needs.load(() => listVesselNeeds(this.id));
  loadOrders = () => this.orders.load(async () => inOrder(await listOrders(this.id)));
  loadPlan = () => this.plan.load(async () => (await findSchedule()).plan ?? null);
  loadModel = async () => {
    await this.model.load(() => findModel(this.id, this.compass));
    if (this.model.value) void this.loadPrior();
    await this.#loadForetelling();
  };
  loadPrior = () => this.prior.load(() => findPrior(this.id, this.compass));
  loadCoverage = () => this.coverage.load(() => findCoverage(this.id, this.compass));
  loadTimeline = () => this.timeline.load(() => findTimeline(this.id, this.compass));
  loadPicture = () => this.picture.load(() => findPicture(this.id, this.#since(), this.compass));
  loadAgents = () => this.agents.load(() => listAgents(this.id));
  loadLogbook = () => this.logbook.load(() => listLogbook(this.id, this.#logbookLines));
  loadAzimuths = () => this.azimuths.load(() => listAzimuths(this.id, this.#azimuthLines));

  #loadHappened = () =>
    this.happened.load(async () => {
      const [entries, calls] = await Promise.all([
        listLogbookSince(this.id, this.#since()),
        listCallsSince(this.id, this.#since()),
      ]);
      return { entries, calls };
    });

  /** What belongs to the compass that is chosen, by name. */
  #ofCompass = {
    model: this.loadModel,
    curve: () => {
      this.placed.reload();
    },
    coverage: this.loadCoverage,
    timeline: this.loadTimeline,
    picture: this.loadPicture,
    happened: this.#loadHappened,
  };
  #ofVessel = { agents: this.loadAgents, logbook: this.loadLogbook, azimuths: this.loadAzimuths };

  /** What was asked for: what stands on a tab that was opened. */
  #wanted = new Set<Part>();
  /** Whether it is known which vessel and compass it is about. */
  #found = false;

  /** Asks for what stands on a tab, unless that is there. */
  open(tab: VesselTab): void {
    const parts = partsOf[tab].filter((part) => !this.#wanted.has(part));
    for (const part of parts) this.#wanted.add(part);
    if (this.#found) this.#ask(parts);
  }

  /** What stands above all tabs, and then what stands on those that were opened. */
  loadAll = async (): Promise<void> => {
    const needed = this.loadNeeds();
    void this.glance.load(() => findAtAGlance(this.id));
    void this.loadOrders();
    await this.loadVessel();
    if (!this.vessel.value) return;
    // What is not hers is as if it were not named.
    this.compass ??= this.vessel.value.compasses.find(({ id }) => id === this.#named)?.id;
    await needed;
    // What is seen first is drawn before the rest is asked for.
    await new Promise((drawn) => setTimeout(drawn));
    this.#found = true;
    this.#ask([...this.#wanted]);
    // Only what is due is planned.
    if (this.needs.value?.length) void this.loadPlan();
  };

  /** Keeps it up to date until the function it returns is called. */
  follow(): () => void {
    const again = (parts: readonly Part[]) => {
      this.#ask(parts.filter((part) => this.#wanted.has(part)));
    };
    const light = gathered(() => {
      void this.loadVessel();
      again(['agents']);
    }, lightMs);
    const heavy = gathered(() => {
      void this.loadNeeds();
      again(ofCompass);
    }, heavyMs);
    const stop = live.listen((news) => {
      if (news.vesselId !== null && news.vesselId !== this.id) return;
      light.call();
      if (news.kind === 'logbook' || news.kind === 'all') again(['logbook', 'azimuths']);
      if (['logbook', 'port_call'].includes(news.kind)) again(['happened']);
      if (news.kind === 'work_order' || news.kind === 'all') {
        void this.loadOrders();
        void this.loadPlan();
        void this.#loadForetelling();
      }
      // An order's steps change nothing else here.
      if (news.kind !== 'batch' && news.kind !== 'work_order') heavy.call();
    });
    return () => {
      light.stop();
      heavy.stop();
      stop();
    };
  }

  chooseCompass = (chosen: string): void => {
    this.compass = chosen;
    const { model, prior, placed, picture, coverage, timeline } = this;
    const resources = [model, prior, placed, picture, coverage, timeline];
    for (const resource of resources) resource.clear();
    this.#ask(ofCompass.filter((part) => this.#wanted.has(part)));
  };

  /** Shows the compass that the address names, where it is hers and another than is shown. */
  nameCompass = (named: string | undefined): void => {
    this.#named = named;
    const compasses = this.vessel.value?.compasses ?? [];
    const shown = this.compass ?? compasses[0]?.id;
    if (named === undefined || named === shown) return;
    if (compasses.some(({ id }) => id === named)) this.chooseCompass(named);
  };

  choosePeriod = (days: number): void => {
    this.period = days;
    void this.loadPicture();
    void this.#loadHappened();
  };

  showEarlier = (): void => {
    this.#logbookLines += logbookStep;
    void this.loadLogbook();
  };

  showEarlierAzimuths = (): void => {
    this.#azimuthLines += logbookStep;
    void this.loadAzimuths();
  };

  #ask(parts: readonly Part[]): void {
    const load = { ...this.#ofCompass, ...this.#ofVessel };
    for (const part of parts) void load[part]();
  }

  async #loadForetelling(): Promise<void> {
    const by = this.model.value?.foretold_by;
    if (by) await this.#foretelling.load(() => findOrder(by));
  }

  /** Counted back from what there is: recorded data may be of years ago. */
  #since(): string {
    const latest = Date.parse(this.vessel.value?.last_position?.at ?? '') || Date.now();
    return new Date(latest - this.period * dayMs).toISOString();
  }
}
