import type * as en from '../deviation';
import type { Translation } from './translation';

export const deviation: Translation<typeof en.deviation> = {
  title: 'Desvío',
  lead: 'Lo que la aguja se aparta del rumbo magnético: magnético = aguja + desvío, positivo al este.',
  axisX: 'Rumbo de aguja',
  axisY: 'Desvío',
  band: 'Banda del 95 %',
  curve: 'Desvío',
  used: 'Muestra',
  unused: 'Fuera del ajuste',
  legend: 'Leyenda',
  samples: 'Muestras',
  show: {
    here: 'En este lugar',
    measured: 'Según se midieron',
    none: 'Ninguna',
  },
  showLong: {
    here: 'Las muestras se trasladan a este lugar: cada una dista de la curva lo que distaba del modelo donde se tomó.',
    measured:
      'Las muestras figuran con el desvío medido donde se tomaron, que difiere del desvío aquí.',
    none: '',
  },
  notDrawn: {
    adjusted: (none) =>
      `Las muestras anteriores a la compensación no se dibujan: no dicen nada de esta curva.${none ? ' Desde entonces no hay ninguna.' : ''}`,
    earlier: (from) =>
      `Las muestras anteriores a ${from} no se dibujan: el magnetismo del buque era otro.`,
  },
  drawn: (drawn, all) => `${drawn} de ${all} muestras dibujadas.`,
  place: 'Lugar y fecha',
  latitude: 'Latitud',
  longitude: 'Longitud',
  date: 'Fecha',
  apply: 'Mostrar',
  more: 'Otros lugares, tablilla y libro',
  reset: 'Volver a la última posición',
  choose: 'Elegir otro lugar',
  close: 'Cerrar',
  map: {
    label: 'Mapa del lugar para el que vale la curva',
    help: 'Más y menos amplían y reducen; Mayúsculas con una flecha mueve el mapa. El buque se mueve con sus propias flechas.',
    home: 'Su derrota',
    ship: (place) => `El buque, en ${place}`,
    shipHelp: 'Las flechas mueven el buque un grado; con Mayúsculas, diez.',
    hint: 'Arrastrar el buque o pulsar donde deba estar: curva, tabla y tablilla son para ese lugar.',
    worstHere: 'Mayor desvío donde está',
    worstThere: 'Mayor desvío allí',
  },
  latitudeWrong: 'Latitud: se escribe como 54 30 N o 54.5.',
  longitudeWrong: 'Longitud: se escribe como 018 40 E o 18.67.',
  dateWrong: 'Fecha: elegir un día.',
  at: (place, day) => `En ${place}, ${day}`,
  variationThere: (variation) => `declinación ${variation}`,
  fieldThere: (h, z) => `campo ${h} horizontal, ${z} vertical`,
  summary: (max, on, min, onMin) =>
    `Desvío según el rumbo de aguja, de ${min} a ${onMin} hasta ${max} a ${on}. La tabla de desvíos tiene las mismas cifras.`,
  bandSummary: (narrow, wide) =>
    narrow === wide ? `Banda de ${narrow} en todos.` : `Banda de ${narrow} a ${wide}.`,
  tip: (compass, deviation, band, magnetic) =>
    `Aguja ${compass}\n${deviation} ${band}\nMagnético ${magnetic}`,
  noBand: 'Este modelo llegó sin errores: no se puede dar ninguna banda.',
  uncertain: (wide) =>
    `La banda es de ${wide} o más en algunos rumbos: faltan datos de esta latitud magnética.`,
};

export const table: Translation<typeof en.table> = {
  title: 'Tabla de desvíos',
  caption: (place, day) => `Desvío cada 15° de rumbo de aguja en ${place}, ${day}`,
  compass: 'Aguja',
  magnetic: 'Magnético',
  point: 'Cuarta',
  deviation: 'Desvío',
  band: '95 %',
};

export const residuals: Translation<typeof en.residuals> = {
  title: 'Residuos a lo largo del tiempo',
  lead: 'Desvío medido menos previsto, cada muestra con el modelo de su época. Aquí se ve lo que los modelos no explican: dispersión, y una pendiente todavía demasiado pequeña para llamarla cambio.',
  axisY: 'Residuo',
  axisX: 'Día, UTC',
  mean: 'Media diaria',
  meanWeekly: 'Media semanal',
  summary: (n, rms, from, to) =>
    `${n} residuos, ${rms} rms, de ${from} a ${to}. La tabla de abajo los da por día o semana.`,
  table: 'Los residuos en una tabla',
  caption: 'Residuos por intervalo, muestras usadas en el ajuste',
  from: 'Desde, UTC',
  samples: 'Muestras',
  meanColumn: 'Media',
  rmsColumn: 'rms',
  none: 'Todavía no hay residuos: necesitan un modelo.',
  period: 'Periodo',
  days: (n) => `${n} días`,
};

export const coverage: Translation<typeof en.coverage> = {
  title: 'Cobertura',
  lead: 'Muestras por rumbo de aguja y latitud magnética. Los rumbos fijan la curva donde ha estado el buque; otras latitudes magnéticas la fijan en los demás lugares.',
  caption: 'Número de muestras por rumbo de aguja (columnas) y latitud magnética (filas)',
  band: 'Latitud magnética',
  range: (from, to) => `${from} a ${to}`,
  total: 'Todas',
  summaryAll: (bands) =>
    `Todos los rumbos están cubiertos; ${bands === 1 ? 'una franja' : `${bands} franjas`} de latitud magnética.`,
  summaryGaps: (gaps) => `Todavía no hay muestras en los rumbos de aguja ${gaps}.`,
  none: 'Todavía no hay muestras.',
  rose: 'Muestras por rumbo de aguja, norte arriba, y por latitud magnética, el anillo más septentrional por fuera. La tabla de abajo tiene las cifras.',
  ring: (from, to) => `${from} – ${to}`,
  density: 'de ninguna al máximo de muestras',
  advised: 'conviene navegar a continuación',
  oneBand:
    'Todas las muestras son de una sola franja de latitud magnética: todavía no se pueden separar el magnetismo permanente y el inducido, y la curva en un lugar lejano se apoya en la experiencia de otros buques.',
  north: (v) => `${v} N`,
  south: (v) => `${v} S`,
};

export const sailNext: Translation<typeof en.sailNext> = {
  title: 'Qué navegar a continuación',
  lead: 'Dónde una guardia enseñaría más de esta aguja: cuatro horas a un rumbo de aguja; tres guardias son en tres días seguidos. La banda es la del 95 %, media de todos los rumbos.',
  here: 'En estas aguas',
  elsewhere: 'Para otras aguas',
  between: (from, to) => `Entre ${from} y ${to}`,
  anyHeading: 'A cualquier rumbo',
  latitudes: (from, to) => `Entre ${from} y ${to}, latitud magnética`,
  and: (before, last) => `${before} y ${last}`,
  gainHere: (now, one, three) =>
    `Una guardia estrecharía la banda de ${now} a ${one}; tres guardias a uno de estos rumbos, a ${three}.`,
  gainElsewhere: (now, heading, one, headings, three) =>
    `Una guardia a unos ${heading} allí estrecharía la banda en otras aguas de ${now} a ${one}; tres guardias (${headings}), a ${three}.`,
  elsewhereNow: (mean, worst) =>
    `En otras latitudes magnéticas la banda es de ${mean} de media y de ${worst} en el peor caso.`,
  nothing: (band, floor, most) =>
    `Ni una guardia ni tres estrecharían la banda de forma apreciable. Es de ${band}, y el error constante propio de la referencia, que ningún rumbo revela, es ya de ${floor}: nada que se navegue estrecha la banda más de ${most}.`,
  takeAzimuths: 'Tomar un azimut',
  gainAzimuths: (now, one, many) =>
    `Solo los azimutes revelan el error de la propia giroscópica o del compás satelital. Uno, del sol o de una enfilación, estrecharía la banda aquí de ${now} a ${one}; veinte a lo largo de un viaje, a ${many}.`,
  magneticLatitude:
    'La latitud magnética sigue la inclinación del campo terrestre; difiere de la latitud de la carta en unos diez grados.',
};

export const parameters: Translation<typeof en.parameters> = {
  title: 'El magnetismo del buque',
  lead: 'Las siete magnitudes que forman la curva, cada una en proporción al apantallamiento medio λ, y la constante.',
  name: 'Magnitud',
  value: 'Valor ± error típico',
  basis: 'Se conoce por',
  bases: {
    own: 'sus propios rumbos',
    mostly: 'sobre todo los suyos',
    little: 'sobre todo buques en general',
    ships: 'buques en general',
    unknown: 'no consta',
  },
  shareTitle: (percent) => `Se ha resuelto el ${percent} de lo que antes era incierto`,
  names: {
    bx_nt: ['Magnetismo permanente longitudinal', 'P, positivo a proa'],
    chi13: ['Longitudinal, inducido por el campo vertical', 'c'],
    by_nt: ['Magnetismo permanente transversal', 'Q, positivo a estribor'],
    chi23: ['Transversal, inducido por el campo vertical', 'f'],
    chi11_minus_chi22: ['Hierro dulce horizontal, longitudinal menos transversal', 'a − e'],
    chi12: ['Longitudinal, inducido por el campo transversal', 'b'],
    chi21: ['Transversal, inducido por el campo longitudinal', 'd'],
    constant_deg: ['Constante', 'errores de alineación, referencia y declinación'],
  },
  summary: (own, all) =>
    own === all
      ? 'Sus propios rumbos las distinguen todas.'
      : `Sus propios rumbos distinguen ${own} de las ${all}. Donde ha estado, la curva solo necesita sus sumas, los coeficientes.`,
  help: 'Lo que no distinguen se apoya en lo habitual en los buques, o en cómo era el buque antes de una reparación.',
  about: 'Lo que de algunas solo se conoce en conjunto',
  pairs:
    'Una sola latitud magnética da P + c Z y Q + f Z, los campos de los coeficientes B y C, mucho mejor que sus partes; navegar a otra da las partes.',
  constant:
    'Los rumbos no distinguen la constante de A = (d − b)/2, ni el error de la línea de fe del de la referencia o la declinación: solo se conoce el conjunto, que figura como coeficiente A (incluye errores de alineación, referencia y declinación). E es la mitad de b + d.',
  condition: (ratio) =>
    `Según sus propios datos, la combinación peor conocida es ${ratio} veces menos segura que la mejor.`,
  conditionOpen: 'Sus propios datos dejan una combinación del todo abierta.',
  details: 'De dónde proceden estas cifras',
  hash: 'Datos de entrada',
  estimator: 'Estimador',
  created: 'Calculado',
  epoch: 'Época',
  epochOpen: 'ahora',
  epochStart: 'el principio',
  to: 'a',
};

export const coefficients: Translation<typeof en.coefficients> = {
  title: 'Coeficientes',
  lead: 'En la última posición. Los exactos, con sus errores típicos, dan la curva por la fórmula exacta; los de manual son la aproximación de cinco términos que usan las tablas antiguas y los compensadores.',
  name: 'Coeficiente',
  exact: 'Exacto',
  handbook: 'De manual',
  meaning: {
    A: 'igual a todos los rumbos (incluye errores de alineación, referencia y declinación)',
    B: 'magnetismo longitudinal: máximo al este y al oeste',
    C: 'magnetismo transversal: máximo al norte y al sur',
    D: 'hierro dulce longitudinal y transversal: cuadrantal, máximo a los rumbos cuadrantales',
    E: 'hierro dulce oblicuo: cuadrantal, máximo a los rumbos cardinales',
  },
};
