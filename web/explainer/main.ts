// SPDX-License-Identifier: Apache-2.0
import '../src/base.css';
import './explainer.css';
import { TactusFigure } from './figure';

customElements.define('tactus-figure', TactusFigure);
