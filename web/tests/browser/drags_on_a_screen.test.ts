import { describeDrags } from './drags';

describeDrags({ phone: false });
