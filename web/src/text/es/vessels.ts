import type * as en from '../vessels';
import type { Translation } from './translation';

export const vessels: Translation<typeof en.vessels> = {
  imo: 'IMO',
  onHeading: (heading) => `a ${heading}`,
  band: (band) => `${band} (95 %)`,
  noModel: 'Todavía sin modelo',
  noUpload: 'todavía no se ha recibido nada',
  noPosition: 'todavía sin posición',
  emptyTitle: 'Todavía no hay buques',
  emptyAdmin:
    'Añadir el primer buque; después dar de alta el agente a bordo, y su aguja empieza a medirse.',
  emptyViewer: 'Los buques los añade un administrador de la compañía.',
  add: 'Añadir un buque',
  addTitle: 'Añadir un buque',
  fieldName: 'Nombre',
  fieldImo: 'Número IMO',
  fieldCallSign: 'Indicativo de llamada',
  fieldFlag: 'Bandera',

  create: 'Añadir el buque',
  creating: 'Añadiendo…',
  nameMissing: 'El buque necesita un nombre.',
};

export const service: Translation<typeof en.service> = {
  end: 'Dar de baja…',
  question:
    '¿Vendido, amarrado o desguazado? No figura en ninguna lista de la flota, sus alertas ' +
    'terminan y no necesita nada más. Todo lo guardado se conserva, también lo que sus agentes ' +
    'sigan enviando, y se puede volver a dar de alta en cualquier momento.',
  confirm: 'Dar de baja',
  resume: 'Volver a dar de alta',
  out: (since) =>
    `De baja desde ${since}: no figura en ninguna lista de la flota ni genera alertas.`,
  list: 'Buques dados de baja',
  none: 'Todos los buques están en servicio.',
  since: (since) => `desde ${since}`,
};
